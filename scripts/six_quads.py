# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a picture of the curves that are drawn on a head, the patches that become of them, and levels of the remesh.

blender --background --factory-startup --python six_quads.py -- STAGE DRAWN.blend PICTURE.png"""

import os
import sys

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import tiles  # noqa: E402
from levels_picture import PASTELS  # noqa: E402
from tiles import attribute, coordinates  # noqa: E402


def main():
    stage, path, target = sys.argv[sys.argv.index("--") + 1 :]
    sys.path.insert(0, stage)
    import hybrid_mesh

    hybrid_mesh.register()
    from hybrid_mesh.bridge import strokes
    from hybrid_mesh.features.layouts import properties as layouts

    bpy.ops.wm.open_mainfile(filepath=os.path.abspath(path))
    scene = bpy.context.scene
    obj = next(one for one in scene.objects if one.type == "MESH")
    lines = [stroke.points for stroke in strokes.read(layouts.layout_of(obj, scene), scene.frame_current)]
    bpy.context.view_layer.objects.active = obj
    scene.hybrid_mesh.vertices, scene.hybrid_mesh.levels = 0, 6
    assert bpy.ops.hybrid_mesh.remesh_layout() == {"FINISHED"}
    levels = tiles.levels_of(bpy.context.object.hybrid_mesh.hierarchy)
    fine = levels["N6"].data
    patches = attribute(fine, "root")
    sheet, around = tiles.Sheet(), coordinates(obj.data)
    shown = [
        tiles.Tile(f"{len(lines)} curves", [sheet.shown(obj.data, lines=False), tiles.tubes(lines, 0.012, sheet.stroke)], around),
        tiles.Tile(f"{len(levels['N0'].data.polygons)} patches", [sheet.shown(fine, colors=PASTELS[patches % len(PASTELS)], drawn=tiles.borders(fine, patches))], around),
    ]
    for name in ("N3", "N5"):
        mesh = levels[name].data
        shown.append(tiles.Tile(f"{name}: {len(mesh.polygons):,} quads", [sheet.shown(mesh, colors=PASTELS[attribute(mesh, "root") % len(PASTELS)])], around))
    sheet.render(shown, len(shown), target, rotation=tiles.view(numpy.radians(33)), percent=85)


if __name__ == "__main__":
    main()
