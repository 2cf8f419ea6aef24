# SPDX-License-Identifier: GPL-3.0-or-later
"""Esc ends Remesh from Layout within half a second, whatever it is at, and leaves the mesh, its layout and the mode as they were."""

import os
import sys
import time

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402
from hybrid_mesh.bridge import strokes  # noqa: E402
from hybrid_mesh.features.layouts import properties  # noqa: E402

CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]


def cube_lines(obj):
    lines = []
    for i, start in enumerate(CORNERS):
        for end in CORNERS[i + 1 :]:
            if sum(a != b for a, b in zip(start, end)) == 1:
                way = numpy.linspace(start, end, 15)
                lines.append(numpy.array([obj.matrix_world @ obj.ray_cast((0, 0, 0), tuple(direction))[1] for direction in way]))
    return lines


def state():
    """Everything that the operator could have changed."""
    scan = bpy.data.objects["sphere"]
    layout = properties.layout_of(scan, bpy.context.scene)
    drawn = [stroke.points.tobytes() for stroke in strokes.read(layout, bpy.context.scene.frame_current)]
    objects = sorted((obj.name, obj.hide_get(), obj.select_get(), tuple(map(tuple, obj.matrix_world))) for obj in bpy.context.view_layer.objects)
    blocks = [sorted(blocks.keys()) for blocks in (bpy.data.meshes, bpy.data.collections, bpy.data.texts, bpy.data.node_groups, bpy.data.materials)]
    return objects, blocks, drawn, bpy.context.view_layer.objects.active.name, bpy.context.mode, len(layout.hybrid_mesh_layout.problems)


def steps():
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.object.delete()
        # Not what is measured: how long a software renderer takes to draw so many faces.
        scan = stepper.large_sphere()
        scan.display_type = "BOUNDS"
        assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
        layout = properties.layout_of(scan, bpy.context.scene)
        strokes.write(layout, layout.data.layers.active, bpy.context.scene.frame_current, cube_lines(scan))
    bpy.context.scene.hybrid_mesh.vertices = 50000
    yield 2
    before = state()
    assert before[4] == "PAINT_GPENCIL" and len(before[2]) == 12
    for delay in (1.0, 0.1, 0.3):
        with bpy.context.temp_override(**stepper.view()):
            assert bpy.ops.hybrid_mesh.remesh_layout("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
        yield delay
        assert jobs.running(), "it was done before Esc could be pressed"
        began = time.monotonic()
        stepper.press("ESC")
        yield from stepper.wait_until(lambda: not jobs.running(), 10)
        seconds = time.monotonic() - began
        print(f"Esc after {delay} s: ended in {seconds:.2f} s")
        assert seconds < 0.5
        yield 0.2
        assert state() == before
        yield 0.5
    # The layout is one that can be remeshed.
    bpy.context.scene.hybrid_mesh.vertices = 2000
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.remesh_layout("INVOKE_DEFAULT", True) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.3
    assert "sphere hierarchy" in bpy.data.collections and bpy.context.mode == "OBJECT"


stepper.run(steps)
