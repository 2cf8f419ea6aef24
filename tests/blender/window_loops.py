# SPDX-License-Identifier: GPL-3.0-or-later
"""Esc ends Find Loops at once and leaves nothing; one that is let run is one undo step."""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402
from hybrid_mesh.features.topology import display, properties  # noqa: E402


def start():
    return bpy.ops.hybrid_mesh.find_loops("INVOKE_DEFAULT", True)


def found():
    return len(properties.loops_of(bpy.data.objects["torus"]))


def steps():
    stepper.empty_scene()
    with bpy.context.temp_override(**stepper.view()):
        # Large, so that there is something to end.
        bpy.ops.mesh.primitive_torus_add(major_segments=800, minor_segments=400, major_radius=1, minor_radius=0.4)
        bpy.context.object.name = "torus"
        bpy.context.object.display_type = "BOUNDS"
        bpy.ops.ed.undo_push(message="before")
    yield 1

    def unchanged():
        assert not found() and len(bpy.data.objects) == 1 and not bpy.data.curves

    yield from stepper.cancel_by_escape(start, unchanged, (0.1, 0.6))
    with bpy.context.temp_override(**stepper.view()):
        assert start() == {"RUNNING_MODAL"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.3
    assert found() == 1 and display.shown_loops(bpy.data.objects["torus"]) is not None
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.ed.undo()
    yield 0.3
    unchanged()


stepper.run(steps)
