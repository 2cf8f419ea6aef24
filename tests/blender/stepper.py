# SPDX-License-Identifier: GPL-3.0-or-later
"""For tests that need a window: Python steps between which Blender's event loop runs."""

import os
import sys
import time
import traceback

import bpy


class Watched:
    """stderr that remembers whether a traceback went by; Blender prints what a panel's draw raises and goes on."""

    def __init__(self, stream):
        self.stream, self.text = stream, ""

    def write(self, text):
        self.text += text
        return self.stream.write(text)

    def flush(self):
        self.stream.flush()


def run(steps, quit_at_end=True):
    """steps: a generator function; each yield is the number of seconds until it goes on. Ends Blender with 1 where something is wrong."""
    sys.stderr = Watched(sys.stderr)

    def whole():
        press("ESC")  # the splash screen
        # A software renderer would draw every view over and over for it.
        bpy.context.preferences.system.viewport_aa = "OFF"
        yield 0.5
        yield from steps()

    generator = whole()

    def advance():
        try:
            wait = next(generator, None)
            if wait is not None:
                return wait
            assert "Traceback" not in sys.stderr.text, "a traceback was printed"
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
            sys.stdout.flush()
            os._exit(1)
        print("window test passed", flush=True)
        if quit_at_end:
            bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(advance, first_interval=1.5)


def view():
    """The context members of the 3D view, for temp_override."""
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window, "screen": window.screen, "area": area, "region": region, "space_data": area.spaces.active}


def press(key):
    window = bpy.context.window_manager.windows[0]
    where = {"x": window.width // 2, "y": window.height // 2}
    window.event_simulate(type=key, value="PRESS", **where)
    window.event_simulate(type=key, value="RELEASE", **where)


def draw(path):
    """Draws a line by mouse through places of the window, in pixels. Use with `yield from`."""
    window = bpy.context.window_manager.windows[0]

    def event(kind, value, place):
        window.event_simulate(type=kind, value=value, x=int(place[0]), y=int(place[1]))

    event("MOUSEMOVE", "NOTHING", path[0])
    yield 0.2
    event("LEFTMOUSE", "PRESS", path[0])
    yield 0.1
    for place in path:
        event("MOUSEMOVE", "NOTHING", place)
        yield 0.02
    event("LEFTMOUSE", "RELEASE", path[-1])
    yield 1


def wait_until(condition, limit=200.0):
    """Yields until the condition holds; fails after `limit` seconds. Use with `yield from`; returns the seconds that it took."""
    began = time.monotonic()
    while not condition():
        assert time.monotonic() - began < limit, "waited in vain"
        yield 0.01
    return time.monotonic() - began


def cancel_by_escape(start, unchanged, delays):
    """Starts a job and presses Esc some seconds later, or once a function says so, for each of the delays. Use with `yield from`.

    start(): runs the operator, in the context of the 3D view; unchanged(): asserts that nothing is left of it.
    """
    from hybrid_mesh import jobs

    for delay in delays:
        with bpy.context.temp_override(**view()):
            assert start() == {"RUNNING_MODAL"}
        if callable(delay):
            yield from wait_until(delay)
        else:
            yield delay
        assert jobs.running(), "it was done before Esc could be pressed"
        press("ESC")
        seconds = yield from wait_until(lambda: not jobs.running(), 10)
        print(f"Esc {'where it was asked for' if callable(delay) else f'after {delay} s'}: ended in {seconds:.2f} s")
        yield 0.2
        unchanged()
        yield 1


def screenshot(name):
    """Kept for people where HYBRID_MESH_SCREENSHOTS names a folder."""
    folder = os.environ.get("HYBRID_MESH_SCREENSHOTS")
    if folder:
        with bpy.context.temp_override(**view()):
            bpy.ops.screen.screenshot(filepath=os.path.join(folder, name + ".png"))


def empty_scene():
    with bpy.context.temp_override(**view()):
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.object.delete()


def large_sphere(rings=160):
    """About 2 * rings^2 vertices, lumpy, selected and active."""
    import numpy

    bpy.ops.mesh.primitive_uv_sphere_add(segments=2 * rings, ring_count=rings, radius=1)
    obj = bpy.context.object
    points = numpy.empty(3 * len(obj.data.vertices), dtype=numpy.float32)
    obj.data.vertices.foreach_get("co", points)
    points = points.reshape(-1, 3)
    points *= (1 + 0.2 * numpy.sin(4 * points[:, :1]) * numpy.cos(3 * points[:, 1:2]))
    obj.data.vertices.foreach_set("co", points.ravel())
    obj.data.update()
    obj.name = "sphere"
    return obj
