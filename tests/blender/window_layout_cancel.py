# SPDX-License-Identifier: GPL-3.0-or-later
"""Esc ends Check Layout and Remesh from Layout, whatever they are at, and leaves the mesh, its layout and the mode as they were."""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from cube import cube_lines  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402
from hybrid_mesh.bridge import strokes  # noqa: E402
from hybrid_mesh.features.layouts import properties  # noqa: E402


def state():
    """Everything that the operator could have changed."""
    scan = bpy.data.objects["sphere"]
    layout = properties.layout_of(scan, bpy.context.scene)
    drawn = [stroke.points.tobytes() for stroke in strokes.read(layout, bpy.context.scene.frame_current)]
    objects = sorted((obj.name, obj.hide_get(), obj.select_get(), tuple(map(tuple, obj.matrix_world))) for obj in bpy.context.view_layer.objects)
    blocks = [sorted(blocks.keys()) for blocks in (bpy.data.meshes, bpy.data.collections, bpy.data.texts, bpy.data.node_groups, bpy.data.materials)]
    return objects, blocks, drawn, bpy.context.view_layer.objects.active.name, bpy.context.mode, len(layout.hybrid_mesh_layout.problems)


def steps():
    stepper.empty_scene()
    with bpy.context.temp_override(**stepper.view()):
        # Not what is measured: how long a software renderer takes to draw so many faces.
        scan = stepper.large_sphere(200)
        scan.display_type = "BOUNDS"
        assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
        layout = properties.layout_of(scan, bpy.context.scene)
        strokes.write(layout, layout.data.layers.active, bpy.context.scene.frame_current, cube_lines(scan, 15))
    bpy.context.scene.hybrid_mesh.vertices = 50000
    yield 2
    before = state()
    assert before[4] == "PAINT_GPENCIL" and len(before[2]) == 12

    def unchanged():
        assert state() == before

    yield from stepper.cancel_by_escape(lambda: bpy.ops.hybrid_mesh.check_layout("INVOKE_DEFAULT", True), unchanged, (0, 0.1))
    yield from stepper.cancel_by_escape(lambda: bpy.ops.hybrid_mesh.remesh_layout("INVOKE_DEFAULT", True), unchanged, (1.0, 0.1, 0.3))
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.check_layout("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
        # A second one has to wait its turn.
        assert bpy.ops.hybrid_mesh.check_layout("INVOKE_DEFAULT", True) == {"CANCELLED"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.3
    assert layout.hybrid_mesh_layout.summary == "8 nodes, 12 curves, 6 faces" and bpy.context.mode == "PAINT_GPENCIL"
    assert state()[2] == before[2] and properties.layout_of(scan, bpy.context.scene, "CURVES") is not None
    # The layout is one that can be remeshed.
    bpy.context.scene.hybrid_mesh.vertices = 2000
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.remesh_layout("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.3
    assert "sphere hierarchy" in bpy.data.collections and bpy.context.mode == "OBJECT"


stepper.run(steps)
