# SPDX-License-Identifier: GPL-3.0-or-later
"""Esc ends a running remesh of 50,000 vertices and leaves nothing; one that is let run is one undo step."""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402


def made():
    return [name for name in bpy.data.collections.keys() if name.endswith(" hierarchy")]


def nothing_made():
    assert not made() and len(bpy.data.objects) == 1


def steps():
    stepper.empty_scene()
    with bpy.context.temp_override(**stepper.view()):
        # Not what is measured: how long a software renderer takes to draw so many faces.
        stepper.large_sphere().display_type = "BOUNDS"
    yield 2
    yield from stepper.cancel_by_escape(lambda: bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=50000), nothing_made, (0.3, 1.0))

    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.ed.undo_push(message="before")
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", True, vertices=2000) == {"RUNNING_MODAL"}
        # A second one has to wait its turn.
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=2000) == {"CANCELLED"}
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 0.3
    assert made() == ["sphere hierarchy"]
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.ed.undo()
    yield 0.2
    assert not made() and "sphere" in bpy.data.objects, "more or less than one undo step"
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.ed.redo()
    yield 0.2
    assert made() == ["sphere hierarchy"]


stepper.run(steps)
