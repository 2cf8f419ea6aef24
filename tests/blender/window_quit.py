# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender quits with exit code 0 while a remesh runs, and another one that was cancelled may not have ended yet."""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402


def steps():
    with bpy.context.temp_override(**stepper.view()):
        stepper.large_sphere()
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=50000) == {"RUNNING_MODAL"}
    yield 0.5
    stepper.press("ESC")
    yield from stepper.wait_until(lambda: not jobs.running())
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=50000) == {"RUNNING_MODAL"}
    assert jobs.running(), "it was done before Blender was to quit"


stepper.run(steps)
