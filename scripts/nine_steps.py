# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a head is remeshed in nine steps, its nose laid out anew by hand, so to say; a picture of the steps, and a .blend of them side by side.

blender --background --factory-startup --python nine_steps.py -- STAGE HEAD PICTURE.png [SCENE.blend] [OPTIONS]

HEAD is a .blend of one mesh object, or a mesh file. It is looked at from -y with z up; the nose is what reaches farthest toward the viewer. The steps:
a base of three cubes on the neck's boundary; three levels, with their stretch; a region of quads around the nose is selected, with a ring of quads as
buffer; it is cut out; a layout is drawn in it; its new patches; the level with these quads in the place of the old ones; the next level; the adaptive
remesh. What is measured is printed."""

import argparse
import json
import os
import sys
import types

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import nose_layout  # noqa: E402
import tiles  # noqa: E402
from levels_picture import GREY, PASTELS, pastels  # noqa: E402
from tiles import attribute, coordinates  # noqa: E402

CUBES, LEVEL, FINEST = 3, 3, 6
COLUMNS, ROWS = 2, 3


def parsed():
    parser = argparse.ArgumentParser(prog="nine_steps.py")
    parser.add_argument("stage")
    parser.add_argument("head")
    parser.add_argument("picture")
    parser.add_argument("scene", nargs="?")
    parser.add_argument("--turn", nargs=3, type=float, default=(0, 0, 0), metavar="DEGREES", help="Euler angles that set the head upright, its face toward -y")
    parser.add_argument("--neck", type=float, metavar="FRACTION", help="cut the neck open so far up the head's height")
    parser.add_argument("--samples", type=int, default=48, help="of the picture's pixels")
    parser.add_argument("--vertices", type=int, default=20000, help="of the adaptive remesh")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def opened(path, turn, neck):
    """The head as the only object of a scene, two units high, in the middle."""
    from hybrid_mesh.core.native import native

    if path.endswith(".blend"):
        bpy.ops.wm.open_mainfile(filepath=os.path.abspath(path))
        head = next(obj for obj in bpy.context.scene.objects if obj.type == "MESH")
    else:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        points, offsets, indices = native().read_mesh(path)
        mesh = bpy.data.meshes.new("head")
        mesh.from_pydata(points.tolist(), [], [indices[a:b].tolist() for a, b in zip(offsets[:-1], offsets[1:])])
        head = bpy.data.objects.new("head", mesh)
        bpy.context.scene.collection.objects.link(head)
    head.rotation_euler = numpy.radians(turn)
    bpy.context.view_layer.objects.active = head
    head.select_set(True)
    bpy.ops.object.transform_apply()
    low, high = (side[2] for side in bounds(head.data))
    if neck is not None:
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.bisect(plane_co=(0, 0, low + neck * (high - low)), plane_no=(0, 0, 1), clear_inner=True)
        bpy.ops.object.mode_set(mode="OBJECT")
    low, high = bounds(head.data)
    points = (coordinates(head.data) - (low + high) / 2) * (2 / (high - low)[2])
    head.data.vertices.foreach_set("co", points.astype(numpy.float32).ravel())
    head.data.update()
    return head


def bounds(mesh):
    points = coordinates(mesh)
    return points.min(axis=0), points.max(axis=0)


def remeshed(head, settings, plan):
    """The hierarchy of a remesh by a plan."""
    from hybrid_mesh.core.tasks import TaskRun
    from hybrid_mesh.features.remesh import job

    run = TaskRun([job.remesh_task(head, bpy.context.evaluated_depsgraph_get(), settings, plan)])
    run.wait()
    for _, error in run.failures:
        raise error
    ((task, result),) = run.results
    return job.build_hierarchy(bpy.context, head, result, *task.note).collection


def boundary_vertices(mesh):
    """Vertices of edges with a face on one side only."""
    sides = {side for polygon in mesh.polygons for side in polygon.edge_keys}
    faces = dict.fromkeys(sides, 0)
    for polygon in mesh.polygons:
        for side in polygon.edge_keys:
            faces[side] += 1
    return sorted({vertex for side, count in faces.items() if count == 1 for vertex in side})


def select_vertices(obj, vertices):
    """Goes to Edit Mode with these vertices selected and no others."""
    for elements in (obj.data.polygons, obj.data.edges, obj.data.vertices):
        for element in elements:
            element.select = False
    for vertex in vertices:
        obj.data.vertices[vertex].select = True
    bpy.context.scene.tool_settings.mesh_select_mode = (True, False, False)
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")


def figures(mesh, faces):
    stretch, anisotropy = (attribute(mesh, name)[faces] for name in ("stretch", "anisotropy"))
    return f"stretch at most {stretch.max():.2f}, 95 % {numpy.percentile(stretch, 95):.2f}; anisotropy at most {anisotropy.max():.2f}, median {numpy.median(anisotropy):.2f}"


class Steps:
    """What a user does, by the operators of the add-on."""

    def __init__(self, head, vertices):
        from hybrid_mesh.core import settings as core
        from hybrid_mesh.features.levels import properties as hierarchies

        self.points = coordinates(head.data)
        self.before = self.base(head)
        self.block, self.lines = self.layout()
        second = self.repatch()
        self.after = tiles.levels_of(second)
        last = remeshed(head, core.RemeshSettings(levels=8, refinement="adaptive", vertices=vertices), hierarchies.plan_of(second))
        self.final = json.loads(last.hybrid_mesh.report)["final"]
        self.finest = max(tiles.levels_of(last).values(), key=lambda obj: len(obj.data.polygons)).data
        print(f"before: {figures(self.level, self.block.faces)}")
        print(f"after:  {figures(self.changed, numpy.nonzero(attribute(self.changed, 'irregular'))[0])}")
        print(f"final:  {self.final['vertices']} vertices, L2 {self.final['l2']:.2e}, {self.final['scaled_jacobian']['inverted']:.0%} inverted")

    @property
    def level(self):
        return self.before[f"N{LEVEL}"].data

    @property
    def fine(self):
        return self.before[f"N{FINEST}"].data

    @property
    def changed(self):
        return self.after[f"N{LEVEL}"].data

    def base(self, head):
        """Four vertices of the neck's boundary are selected, and cubes put there."""
        settings = bpy.context.scene.hybrid_mesh
        settings.vertices, settings.levels, settings.hide_source = 0, FINEST, False
        rim = boundary_vertices(head.data)
        select_vertices(head, [rim[corner] for corner in nose_layout.four_corners(self.points[rim])])
        assert bpy.ops.hybrid_mesh.remesh_boundary(cubes=CUBES) == {"FINISHED"}
        return tiles.levels_of(bpy.context.object.hybrid_mesh.hierarchy)

    def layout(self):
        """The most stretched quads around the tip of the nose, and curves for them."""
        nose = self.points[self.points[:, 1].argmin()]
        block = nose_layout.block_at(coordinates(self.level), tiles.quads_of(self.level), nose, attribute(self.level, "stretch"), COLUMNS, ROWS)
        corners = coordinates(self.fine)[tiles.quads_of(self.fine).ravel()]
        place = nose_layout.places_on(tiles.corner_uv(self.level), corners, tiles.corner_uv(self.fine))
        return block, nose_layout.skin_lines(block, place, steps=2 ** (FINEST - LEVEL))

    def repatch(self):
        """The quads are selected, the curves drawn over them."""
        from hybrid_mesh.bridge import strokes
        from hybrid_mesh.features.layouts import properties as layouts

        obj = self.before[f"N{LEVEL}"]
        obj.hide_set(False)
        for polygon in obj.data.polygons:
            polygon.select = polygon.index in self.block.faces
        bpy.context.view_layer.objects.active = obj
        bpy.ops.hybrid_mesh.draw_layout()
        layout = layouts.layout_of(obj, bpy.context.scene)
        strokes.write(layout, layout.data.layers.active, bpy.context.scene.frame_current, self.lines)
        # The objects are changed in place.
        self.before = {name: types.SimpleNamespace(data=obj.data.copy()) for name, obj in self.before.items()}
        assert bpy.ops.hybrid_mesh.repatch_region(buffer_rings=1) == {"FINISHED"}
        return bpy.context.object.hybrid_mesh.hierarchy


def pictures(steps, sheet):
    """The nine tiles."""
    level, fine, changed, block = steps.level, steps.fine, steps.changed, steps.block
    buffer = block.around(1)
    roots = {int(root): 0 for root in attribute(level, "root")}
    roots_after = {**{int(root): LEVEL for root in attribute(changed, "root")}, **roots}
    level_cells, patches = tiles.cells(level, roots, LEVEL), tiles.cells(fine, roots, 0)
    base = coordinates(steps.before["N0"].data)[boundary_vertices(steps.before["N0"].data)]
    selected = tiles.grey(level)
    selected[block.faces], selected[buffer] = tiles.REGION, tiles.BUFFER
    # The region with its buffer, cut out of the finest level before and after.
    empty, span = cut_out(sheet, fine, tiles.cells(fine, roots, LEVEL), level_cells[block.faces], level_cells[buffer], lambda cell: GREY)
    after_cells = tiles.cells(steps.after[f"N{FINEST}"].data, roots_after, LEVEL)
    new = numpy.unique(after_cells[attribute(steps.after[f"N{FINEST}"].data, "irregular")])
    filled, _ = cut_out(sheet, steps.after[f"N{FINEST}"].data, after_cells, new, level_cells[buffer], lambda cell: pastels(cell >> 32), new)
    strokes = tiles.tubes(steps.lines, 0.010 * numpy.ptp(span, axis=0).max(), sheet.stroke)
    next_level = steps.after[f"N{LEVEL + 1}"].data
    return [
        tiles.Tile(f"1  base: {CUBES} cubes", [sheet.shown(fine, colors=PASTELS[((patches >> 32) + 2) % len(PASTELS)], drawn=tiles.borders(fine, patches)), tiles.balls(base, 0.03, sheet.ink)], steps.points),
        tiles.Tile(f"2  M{LEVEL}, stretch", [sheet.shown(level, colors=tiles.stretched(level))], steps.points),
        tiles.Tile(f"3  {COLUMNS} x {ROWS} quads, buffer", [sheet.shown(level, colors=selected)], steps.points),
        tiles.Tile("4  cut out", [empty], span),
        tiles.Tile("5  layout drawn", [empty, strokes], span),
        tiles.Tile("6  new patches", [filled], span),
        tiles.Tile(f"7  N{LEVEL}, stretch", [sheet.shown(changed, colors=tiles.stretched(changed))], steps.points),
        tiles.Tile(f"8  M{LEVEL + 1}", [sheet.shown(next_level, colors=tiles.stretched(next_level))], steps.points),
        tiles.Tile(f"9  adaptive, {steps.final['vertices']:,} vertices", [sheet.shown(steps.finest, colors=tiles.grey(steps.finest))], steps.points),
    ]


def cut_out(sheet, mesh, cells, inside, around, color, lines=()):
    """The part of a mesh in some cells, in a colour a cell, and in the cells around them. lines: cells inside that have lines between them. Returns (mesh, its points)."""
    faces = numpy.nonzero(numpy.isin(cells, inside) | numpy.isin(cells, around))[0]
    cell = cells[faces]
    within = numpy.isin(cell, inside)
    piece = tiles.part(mesh, faces)
    drawn = tiles.borders(piece, numpy.where(within & ~numpy.isin(cell, lines), -1, cell))
    return sheet.shown(piece, colors=numpy.where(within[:, None], color(cell), tiles.BUFFER), drawn=drawn), coordinates(piece)


def main():
    arguments = parsed()
    sys.path.insert(0, arguments.stage)
    import hybrid_mesh

    hybrid_mesh.register()
    head = opened(arguments.head, arguments.turn, arguments.neck)
    if bpy.context.scene.world is None:
        bpy.context.scene.world = bpy.data.worlds.new("World")
    steps = Steps(head, arguments.vertices)
    sheet = tiles.Sheet()
    sheet.render(pictures(steps, sheet), 3, arguments.picture, arguments.samples, arguments.scene, percent=66)


if __name__ == "__main__":
    main()
