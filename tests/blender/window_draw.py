# SPDX-License-Identifier: GPL-3.0-or-later
"""A stroke drawn by mouse on a turned and unevenly scaled mesh becomes a curve on its surface; problems are marked, listed and looked at."""

import os
import sys

import bpy
import numpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402
from hybrid_mesh.bridge import meshes, strokes  # noqa: E402
from hybrid_mesh.features.layouts import panel, properties  # noqa: E402


def steps():
    show_panel()
    view = stepper.view()
    stepper.empty_scene()
    with bpy.context.temp_override(**view):
        scan = stepper.large_sphere(30)
        scan.rotation_euler, scan.scale, scan.location = (0.5, 0.3, 1.1), (1.6, 0.8, 1.1), (1, 0.5, -0.3)
        bpy.ops.view3d.view_selected()
        bpy.ops.ed.undo_push(message="before")
        assert bpy.ops.hybrid_mesh.draw_layout("INVOKE_DEFAULT", True) == {"FINISHED"}
    yield 2
    layout = properties.layout_of(scan, bpy.context.scene)
    yield from draw([(-0.5, 0.1), (0, -0.15), (0.5, 0.1)])
    yield from draw([(-0.1, -0.28), (0.05, 0), (-0.05, 0.2)])
    stepper.screenshot("draw_drawn")
    drawn = strokes.read(layout, bpy.context.scene.frame_current)
    assert len(drawn) == 2 and all(len(one.points) > 10 for one in drawn), "the mouse drew nothing"
    tree, size = surface(scan)
    print(f"drawn at most {farthest(tree, drawn) / size:.1e} of the diagonal off the surface")
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.check_layout("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.3
    curves = strokes.read(properties.layout_of(scan, bpy.context.scene, "CURVES"), bpy.context.scene.frame_current)
    lines = [one for one in curves if one.layer == "Curves"]
    off = farthest(tree, lines) / size
    print(f"curves at most {off:.1e} of the diagonal off the surface")
    assert len(lines) == 4 and off < 1e-4  # two strokes that cross
    for one in drawn:
        # The curves go where the mouse went.
        nearest = [min(numpy.linalg.norm(line.points - end, axis=1).min() for line in lines) for end in one.points[[0, -1]]]
        assert max(nearest) < 0.02 * size
    found = layout.hybrid_mesh_layout.problems
    assert [problem.kind for problem in found].count("dangling") == 4
    yield 2
    stepper.screenshot("draw_checked")
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.show_problem("INVOKE_DEFAULT", True, index=1) == {"FINISHED"}
    place = layout.matrix_world @ Vector(found[1].place)
    looked_at = stepper.view()["space_data"].region_3d
    assert (looked_at.view_location - place).length < 1e-4 * size and looked_at.view_distance < size
    assert layout.hybrid_mesh_layout.problem_index == 1
    yield 2
    stepper.screenshot("draw_problem")
    for _ in range(2):
        with bpy.context.temp_override(**stepper.view()):
            bpy.ops.ed.undo()
        yield 0.5
    scan = bpy.data.objects["sphere"]
    layout = properties.layout_of(scan, bpy.context.scene)
    assert properties.layout_of(scan, bpy.context.scene, "CURVES") is None and not layout.hybrid_mesh_layout.problems
    assert len(strokes.read(layout, bpy.context.scene.frame_current)) == 2
    # Without a window, as a script may be, a check is done when it returns.
    with bpy.context.temp_override(window=None, screen=None, area=None, region=None):
        assert bpy.ops.hybrid_mesh.check_layout() == {"FINISHED"}
        assert bpy.ops.hybrid_mesh.show_problem(index=0) == {"FINISHED"}
    assert [problem.kind for problem in layout.hybrid_mesh_layout.problems].count("dangling") == 4


def show_panel():
    # The tab that is open at first, since no script can choose another in this version.
    bpy.utils.unregister_class(panel.HYBRID_MESH_PT_layout)
    panel.HYBRID_MESH_PT_layout.bl_category = "Item"
    bpy.utils.register_class(panel.HYBRID_MESH_PT_layout)
    stepper.view()["space_data"].show_region_ui = True
    bpy.context.preferences.view.ui_scale = 0.8


def draw(corners):
    """Draws a line by mouse through places of the 3D view: (-1, -1) to (1, 1), a unit being the smaller half of its size."""
    region = stepper.view()["region"]
    unit = min(region.width, region.height) / 2
    at = [(region.x + region.width / 2 + unit * x, region.y + region.height / 2 + unit * y) for x, y in corners]
    path = [numpy.array(a) + t * (numpy.array(b) - numpy.array(a)) for a, b in zip(at[:-1], at[1:]) for t in numpy.linspace(0, 1, 25)]
    yield from stepper.draw(path)


def surface(obj):
    source = meshes.read_source(obj, bpy.context.evaluated_depsgraph_get())
    points = source.mesh.points
    return BVHTree.FromPolygons(points.tolist(), source.mesh.indices.reshape(-1, 3).tolist()), numpy.linalg.norm(numpy.ptp(points, axis=0))


def farthest(tree, drawn):
    return max(tree.find_nearest(point.tolist())[3] for one in drawn for point in one.points)


stepper.run(steps)
