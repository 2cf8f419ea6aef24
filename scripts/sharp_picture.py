# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: remeshes of machine parts side by side, their sharp edges red, those of the model that a remesh has lost blue.

blender --background --factory-startup --python sharp_picture.py -- TILES.npz PICTURE.png

TILES.npz: `texts` and `columns`; of tile n `n.around`, points that it is filled by, and if there is a mesh its `n.points`, `n.offsets`, `n.indices`, and
pieces (k, 2, 3) of its `n.sharp` edges and of the `n.lost` ones."""

import os
import sys

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import levels_picture as picture  # noqa: E402
import tiles  # noqa: E402

SHARP, LOST = (0.72, 0.05, 0.03, 1), tiles.STROKE
TURN, TILT = 0.6, 0.6  # radians
RADIUS = 0.0035  # of a tube, of what a tile shows
UNDER = 0.06  # room between a mesh and the two lines of text, of its size
WIDE = 1.15  # of a tile: the longest name of a model has room
SAMPLES = 24


def tile(sheet, inks, text, arrays, rotation):
    """A tile of what there is for it: {name: array}."""
    around = arrays["around"]
    seen = around @ rotation.T
    size = numpy.ptp(seen[:, [0, 2]], axis=0).max()
    around = numpy.concatenate([around, [(seen[seen[:, 2].argmin()] - [0, 0, UNDER * size]) @ rotation]])
    if "points" not in arrays:
        return tiles.Tile(text, [], around)
    mesh = bpy.data.meshes.new(text.splitlines()[0])
    offsets, indices = arrays["offsets"], arrays["indices"].tolist()
    mesh.from_pydata(arrays["points"].tolist(), [], [indices[a:b] for a, b in zip(offsets[:-1], offsets[1:])])
    shown = sheet.shown(mesh, size)
    shown.polygons.foreach_set("use_smooth", [False] * len(shown.polygons))
    blocks = [shown]
    for name, radius in (("sharp", RADIUS), ("lost", 1.5 * RADIUS)):
        if len(arrays[name]):
            blocks.append(tiles.tubes(arrays[name], radius * size, inks[name]))
    return tiles.Tile(text, blocks, around)


def main():
    source, target = sys.argv[sys.argv.index("--") + 1 :]
    sheet, rotation = tiles.Sheet(), tiles.view(TURN, TILT)
    inks = {"sharp": picture.plain_material("Sharp", SHARP), "lost": picture.plain_material("Lost", LOST)}
    with numpy.load(source) as data:
        per_tile = [{} for _ in data["texts"]]
        for key in data.files:
            number, _, name = key.partition(".")
            if name:
                per_tile[int(number)][name] = data[key]
        shown = [tile(sheet, inks, str(text), arrays, rotation) for text, arrays in zip(data["texts"], per_tile)]
        sheet.render(shown, int(data["columns"]), target, SAMPLES, rotation=rotation, wide=WIDE)


if __name__ == "__main__":
    main()
