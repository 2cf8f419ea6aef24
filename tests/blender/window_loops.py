# SPDX-License-Identifier: GPL-3.0-or-later
"""Find Loops shows how far it is and leaves the window free; Esc ends it at once and leaves the list as it was; one that is let run is one undo step."""

import os
import sys
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs  # noqa: E402
from hybrid_mesh.features.topology import display, properties  # noqa: E402


def start():
    return bpy.ops.hybrid_mesh.find_loops("INVOKE_DEFAULT", True)


def found():
    return [(loop.points, loop.level, loop.use, loop.drawn) for loop in properties.loops_of(bpy.data.objects["torus"])]


def is_at(progress):
    """A function that says whether the search is that far: how fast a machine is does not matter then."""
    return lambda: all(run.progress >= progress for run in jobs._runs)


def watched():
    """Runs it to its end; returns how far it was whenever Blender's window had its turn, and the longest that it had to wait for that. Use with `yield from`."""
    with bpy.context.temp_override(**stepper.view()):
        assert start() == {"RUNNING_MODAL"}
    (run,) = jobs._runs
    seen, longest, last = [], 0, time.monotonic()
    while jobs.running():
        seen.append(run.progress)
        yield 0.02
        longest, last = max(longest, time.monotonic() - last), time.monotonic()
    return seen, longest


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

    yield from stepper.cancel_by_escape(start, unchanged, (is_at(0), is_at(0.2), is_at(0.4), is_at(0.6)))
    seen, longest = yield from watched()
    print(f"progress {[round(value, 2) for value in seen[:: max(1, len(seen) // 12)]]}, the window waited for at most {longest:.2f} s")
    # Seen to move from within the window's own loop, which so has its turn while the search goes on.
    assert seen == sorted(seen) and len({int(10 * value) for value in seen}) >= 4
    yield 0.3
    assert len(found()) == 1 and display.shown_loops(bpy.data.objects["torus"]) is not None
    bpy.data.objects["torus"].hybrid_mesh_topology.loops[0].level = 3
    with bpy.context.temp_override(**stepper.view()):
        bpy.ops.ed.undo_push(message="level")
    before = found()

    def as_before():
        assert found() == before and len(bpy.data.objects) == 2

    yield from stepper.cancel_by_escape(start, as_before, (is_at(0.3),))
    for count in (1, 0):
        with bpy.context.temp_override(**stepper.view()):
            bpy.ops.ed.undo()
        yield 0.3
        assert len(found()) == count
    unchanged()


stepper.run(steps)
