# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a picture of what irregular operations are for. A bunny is remeshed semi-regularly from few quads, and again with cubes
on the quad of level 3 that each ear is squeezed into.

blender --background --factory-startup --python ears.py -- STAGE BUNNY.blend PICTURE.png"""

import os
import sys

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import tiles  # noqa: E402
from tiles import attribute, coordinates  # noqa: E402

BASE, LEVEL, FINEST, CUBES, EARS = 14, 3, 6, 3, 2


def head(mesh, low, high):
    """The faces in the upper front of a box, where the bunny has its head."""
    shares = (coordinates(mesh) - low) / (high - low)
    within = (shares[:, 2] > 0.56) & (shares[:, 0] < 0.36 + 0.9 * (shares[:, 2] - 0.56))
    return [polygon.index for polygon in mesh.polygons if within[list(polygon.vertices)].all()]


def main():
    stage, path, target = sys.argv[sys.argv.index("--") + 1 :]
    sys.path.insert(0, stage)
    import hybrid_mesh

    hybrid_mesh.register()
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(path))
    bunny = next(one for one in bpy.context.scene.objects if one.type == "MESH")
    bunny.select_set(True)
    bpy.context.view_layer.objects.active = bunny
    assert bpy.ops.hybrid_mesh.remesh(vertices=0, levels=FINEST, base="GIVEN", base_quads=BASE, semi_regular=True) == {"FINISHED"}
    plain = tiles.levels_of(bpy.context.object.hybrid_mesh.hierarchy)
    levels = plain
    for _ in range(EARS):
        obj = levels[f"N{LEVEL}"]
        stretch = attribute(obj.data, "stretch")
        if "irregular" in obj.data.attributes:
            stretch = numpy.where(attribute(obj.data, "irregular"), 0, stretch)  # that ear is done
        for polygon in obj.data.polygons:
            polygon.select = polygon.index == int(stretch.argmax())
        obj.hide_set(False)
        bpy.context.view_layer.objects.active = obj
        assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=CUBES) == {"FINISHED"}
        levels = tiles.levels_of(bpy.context.object.hybrid_mesh.hierarchy)
    points = coordinates(bunny.data)
    box = points.min(axis=0), points.max(axis=0)
    scan = tiles.part(bunny.data, head(bunny.data, *box))
    around, sheet = coordinates(scan), tiles.Sheet()
    shown = [tiles.Tile("scan", [sheet.shown(scan, lines=False)], around)]
    for text, found in (("semi-regular", plain), (f"{CUBES} cubes an ear", levels)):
        mesh = found[f"N{FINEST}"].data
        faces, stretch = head(mesh, *box), attribute(mesh, "stretch")
        print(f"{text}: {len(mesh.polygons)} quads, stretch at most {stretch.max():.1f}, of the head {stretch[faces].max():.1f}")
        shown.append(tiles.Tile(f"{text}, stretch {stretch[faces].max():.0f}", [sheet.shown(tiles.part(mesh, faces), 1.0, colors=tiles.stretched(mesh)[faces])], around))
    sheet.render(shown, len(shown), target, rotation=tiles.view(0.6))


if __name__ == "__main__":
    main()
