# SPDX-License-Identifier: GPL-3.0-or-later
"""Another file may be opened, and the add-on be switched off, while a remesh runs."""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402


def start():
    with bpy.context.temp_override(**stepper.view()):
        stepper.large_sphere()
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=50000) == {"RUNNING_MODAL"}


def steps():
    start()
    yield 0.3
    assert jobs.running()
    # A persistent timer is not to be had for a function that a generator drives; so it is the load handler itself that is asked.
    jobs._before_load()
    assert not jobs.running()
    yield 0.3
    start()
    yield 0.3
    assert jobs.running()
    bpy.ops.preferences.addon_disable(module="hybrid_mesh")
    yield 0.3
    bpy.ops.preferences.addon_enable(module="hybrid_mesh")
    yield 0.3
    assert bpy.ops.hybrid_mesh.remesh.get_rna_type() is not None


stepper.run(steps)
