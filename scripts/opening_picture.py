# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a picture of how topology opens in a hierarchy: its base, the level below the first one on which something opens, each level on
which something does, and the last one, with the loops that are closed and those that are open.

blender --background --factory-startup --python opening_picture.py -- STAGE FOLDER/NAME.blend PICTURE.png [OPTIONS]

NAME.blend is what `remesh --blend` writes, NAME.plan.json and NAME.report.json are beside it."""

import argparse
import json
import os
import sys

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import levels_picture as picture  # noqa: E402
import tiles  # noqa: E402
from tiles import coordinates  # noqa: E402

CLOSED, OPEN = (0.72, 0.05, 0.03, 1), tiles.STROKE
NARROWEST = 0.64  # of a tile, which the text needs
UNDER = 0.05  # room between a mesh and the two lines of text, of its size


def parsed():
    parser = argparse.ArgumentParser(prog="opening_picture.py")
    parser.add_argument("stage")
    parser.add_argument("hierarchy")
    parser.add_argument("picture")
    parser.add_argument("--turn", type=float, default=numpy.degrees(picture.TURN), metavar="DEGREES", help="about the vertical")
    parser.add_argument("--tilt", type=float, default=0, metavar="DEGREES", help="toward the camera: 90 shows it from above")
    parser.add_argument("--rows", type=int, default=1, help="of tiles")
    parser.add_argument("--radius", type=float, default=0.009, help="of a loop's tube, of what a tile shows")
    parser.add_argument("--samples", type=int, default=64, help="of the picture's pixels")
    parser.add_argument("--percent", type=int, default=100, help="of the picture's full size")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def shape(level):
    """What of a level of the report changes where something opens."""
    return level["genus"], level["components"], level["boundary_loops"]


def shown_levels(levels):
    """The places of the levels that are worth a tile."""
    opening = [k for k in range(1, len(levels)) if shape(levels[k]) != shape(levels[k - 1])]
    if not opening:
        sys.exit("opening_picture.py: nothing opens in this hierarchy above its base")
    return sorted({0, opening[0] - 1, *opening, len(levels) - 1})


def topology(level, levels):
    """What a tile says of a level's topology: what changes among the levels."""
    said = [f"genus {level['genus']:.0f}"] if any(one["genus"] for one in levels) else []
    if any(one["components"] > 1 for one in levels):
        said.append("1 component" if level["components"] == 1 else f"{level['components']} components")
    return ", ".join(said)


def closed_loops(plan, to_object):
    """The plan's loops as closed lines in the space of the level's objects, a list an event, each with the level on which it opens."""
    rotation, shift = to_object[:3, :3], to_object[:3, 3]
    return [([numpy.array(loop + loop[:1]) @ rotation.T + shift for loop in event["loops"]], event["level"]) for event in plan["topology"]]


def whole_tiles(sheet, inks, objects, levels, events, rotation, radius):
    """A tile a level: the mesh, with the loops that are closed there in one colour and those that are open in the other. Also width and height of a tile."""
    numbers = shown_levels(levels)
    meshes = [objects[f"N{levels[k]['level']}"].data for k in numbers]
    # One scale for all: levels are to be compared. The base's corners may reach farther than the scan.
    around = numpy.concatenate([coordinates(mesh) for mesh in meshes])
    seen = around @ rotation.T
    across, tall = numpy.ptp(seen, axis=0)[[0, 2]]
    size = max(across, tall)
    around = numpy.concatenate([around, [(seen[seen[:, 2].argmin()] - [0, 0, UNDER * size]) @ rotation]])
    shown = []
    for k, mesh in zip(numbers, meshes):
        level, blocks = levels[k], [sheet.shown(mesh, size)]
        for is_open in (False, True):
            lines = [line for loops, opens in events if (opens <= level["level"]) == is_open for line in loops]
            if lines and k > 0:  # the base is too coarse to have them on it
                blocks.append(tiles.tubes(lines, radius * size / 2, inks[is_open]))
        shown.append(tiles.Tile(f"N{level['level']}: {level['quads']:,} quads\n{topology(level, levels)}", blocks, around))
    tall += UNDER * size
    return shown, max(NARROWEST, across / max(across, tall)), tall / max(across, tall)


def main():
    arguments = parsed()
    sys.path.insert(0, arguments.stage)
    import hybrid_mesh

    hybrid_mesh.register()
    beside = os.path.splitext(arguments.hierarchy)[0]
    with open(beside + ".report.json", encoding="utf-8") as report, open(beside + ".plan.json", encoding="utf-8") as plan:
        levels, plan = json.load(report)["levels"], json.load(plan)
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(arguments.hierarchy))
    objects = tiles.levels_of(next(collection for collection in bpy.data.collections if collection.hybrid_mesh.preview))
    events = closed_loops(plan, numpy.array(objects["N0"].matrix_world.inverted()))
    sheet = tiles.Sheet()
    inks = {False: picture.plain_material("Closed", CLOSED), True: sheet.stroke}
    rotation = tiles.view(numpy.radians(arguments.turn), numpy.radians(arguments.tilt))
    shown, wide, high = whole_tiles(sheet, inks, objects, levels, events, rotation, arguments.radius)
    for tile in shown:
        print(tile.text.replace("\n", ", "))
    columns = -(-len(shown) // arguments.rows)
    sheet.render(shown, columns, arguments.picture, arguments.samples, rotation=rotation, percent=arguments.percent, wide=wide, high=high)


if __name__ == "__main__":
    main()
