# SPDX-License-Identifier: GPL-3.0-or-later
"""The file browsers of import and export show their settings, and the panel of an imported stream its bytes."""

import os
import sys
import tempfile

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs, registration  # noqa: E402
from hybrid_mesh.features.levels import panel as level_panel  # noqa: E402
from hybrid_mesh.features.levels import streams  # noqa: E402


def browser():
    """The context members of a file browser, for temp_override; None where there is none."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "FILE_BROWSER":
                region = next(region for region in area.regions if region.type == "WINDOW")
                return {"window": window, "screen": window.screen, "area": area, "region": region, "space_data": area.spaces.active}
    return None


def browse(operator, name, **settings):
    """Opens an operator's file browser, and takes a picture of it. Use with `yield from`."""
    with bpy.context.temp_override(**stepper.view()):
        assert operator("INVOKE_DEFAULT", **settings) == {"RUNNING_MODAL"}
    yield from stepper.wait_until(browser)
    browser()["space_data"].show_region_tool_props = True
    yield 2
    folder = os.environ.get("HYBRID_MESH_SCREENSHOTS")
    if folder:
        with bpy.context.temp_override(**browser()):
            bpy.ops.screen.screenshot(filepath=os.path.join(folder, name + ".png"))


def choose(folder, name):
    """Presses the file browser's button."""
    with bpy.context.temp_override(**browser()):
        browser()["space_data"].params.directory = folder.encode()
        browser()["space_data"].params.filename = name
        bpy.ops.file.execute()


def steps():
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    panels = [cls for cls in registration.CLASSES if issubclass(cls, bpy.types.Panel)]
    for cls in reversed(panels):
        bpy.utils.unregister_class(cls)
    # Alone, in the tab that is open at first.
    level_panel.HYBRID_MESH_PT_levels.bl_category = "Item"
    level_panel.HYBRID_MESH_PT_levels.bl_order = -10
    bpy.utils.register_class(level_panel.HYBRID_MESH_PT_levels)
    stepper.view()["space_data"].show_region_ui = True
    stepper.empty_scene()
    folder = tempfile.mkdtemp()
    path = os.path.join(folder, "ball.hmesh")
    with bpy.context.temp_override(**stepper.view()):
        stepper.large_sphere(40)
        assert bpy.ops.hybrid_mesh.remesh(vertices=6000) == {"FINISHED"}
        assert bpy.ops.ed.undo_push(message="remeshed") == {"FINISHED"}
    yield 0.5
    for bound in ("BYTES", "ERROR"):
        yield from browse(bpy.ops.hybrid_mesh.export_hmesh, f"export_{bound.lower()}", kind="STREAM", bound=bound)
        choose(folder, f"{bound.lower()}.hmesh")
        # While it is encoded the window goes on, and Esc ends that.
        yield from stepper.wait_until(jobs.running, 10)
        yield 1  # for a software renderer to draw the view again
        stepper.press("ESC")
        seconds = yield from stepper.wait_until(lambda: not jobs.running() and not jobs._ending, 10)
        print(f"Esc: ended in {seconds:.2f} s")
        assert os.listdir(folder) == [], "it was done before Esc was seen, or went on"
        yield 1
        yield from browse(bpy.ops.hybrid_mesh.export_hmesh, f"export_{bound.lower()}", kind="STREAM", bound=bound)
        choose(folder, f"{bound.lower()}.hmesh")
        yield from stepper.wait_until(lambda: os.listdir(folder) == [f"{bound.lower()}.hmesh"] and not jobs.running(), 60)
        os.remove(os.path.join(folder, f"{bound.lower()}.hmesh"))
        yield 1
    # A container is there at once.
    yield from browse(bpy.ops.hybrid_mesh.export_hmesh, "export_container", kind="CONTAINER")
    choose(folder, "container.hmesh")
    yield from stepper.wait_until(lambda: os.listdir(folder) == ["container.hmesh"], 10)
    yield 1
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.export_hmesh(filepath=path, kind="STREAM") == {"FINISHED"}
    stepper.empty_scene()
    yield from browse(bpy.ops.hybrid_mesh.import_hmesh, "import", part="PREFIX", most_bytes=800)
    choose(folder, "ball.hmesh")
    yield from stepper.wait_until(lambda: "ball.preview" in bpy.data.objects, 60)
    yield 1
    collection = bpy.data.collections["ball hierarchy"]
    assert collection.hybrid_mesh_stream.bytes == 800
    stepper.view()["space_data"].overlay.show_wireframes = True
    for count in (800, 1, collection.hybrid_mesh_stream.size):
        collection.hybrid_mesh_stream.bytes = count
        yield 2
        stepper.screenshot(f"stream_{count}")
    level = next(obj for obj in collection.objects if obj.hybrid_mesh.level == "N1")
    level.hide_set(False)
    bpy.context.view_layer.objects.active = level
    level.data.vertices[0].co.x += 1
    size = collection.hybrid_mesh_stream.bytes
    # A line beside the pointer says that it cannot be done.
    with bpy.context.temp_override(**stepper.view()):
        collection.hybrid_mesh_stream.bytes = 800
    assert collection.hybrid_mesh_stream.bytes == size
    yield 1
    stepper.screenshot("stream_refused")
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.update_levels("INVOKE_DEFAULT", True) == {"FINISHED"}
    yield 1
    stepper.screenshot("stream_edited")
    assert not streams.is_shown(collection)
    bpy.utils.unregister_class(level_panel.HYBRID_MESH_PT_levels)
    for cls in panels:
        bpy.utils.register_class(cls)
    yield 0.5


stepper.run(steps)
