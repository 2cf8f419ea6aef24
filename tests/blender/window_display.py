# SPDX-License-Identifier: GPL-3.0-or-later
"""After a remesh its quads are seen; what is shown changes by choice, by keys and by the wheel, and the view has a legend."""

import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import stepper  # noqa: E402
from hybrid_mesh import jobs, registration  # noqa: E402
from hybrid_mesh.bridge import levels  # noqa: E402
from hybrid_mesh.features.display import legend  # noqa: E402


def held(key, **modifiers):
    window = bpy.context.window_manager.windows[0]
    area = stepper.view()["area"]
    where = {"x": area.x + area.width // 3, "y": area.y + area.height // 2, **modifiers}
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=where["x"], y=where["y"])
    window.event_simulate(type=key, value="PRESS", **where)
    if not key.startswith("WHEEL"):
        window.event_simulate(type=key, value="RELEASE", **where)


def in_first_tab():
    """The panels in the tab that is open at first, since no script can choose another in this version."""
    panels = [cls for cls in registration.CLASSES if issubclass(cls, bpy.types.Panel) and "levels" in cls.__module__]
    for cls in reversed(panels):
        bpy.utils.unregister_class(cls)
    for cls in panels:
        cls.bl_category = "Item"
        cls.bl_order = -10
        cls.bl_options = set()
        bpy.utils.register_class(cls)


def steps():
    view = stepper.view()
    in_first_tab()
    view["space_data"].show_region_ui = True
    bpy.context.preferences.view.ui_scale = 0.8
    stepper.empty_scene()
    with bpy.context.temp_override(**view):
        bpy.ops.mesh.primitive_monkey_add()
        source = bpy.context.object
        source.modifiers.new("smooth", "SUBSURF").levels = 2
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_selected()
    display = bpy.context.scene.hybrid_mesh_display
    with bpy.context.temp_override(**stepper.view()):
        assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=2000, hide_source=True, effort="QUICK") == {"RUNNING_MODAL"}
    yield 0.5
    assert jobs.progress()[1].startswith("Suzanne")
    yield from stepper.wait_until(lambda: not jobs.running())
    yield 2
    preview = bpy.data.objects["Suzanne.preview"]
    assert preview.show_wire and bpy.context.object == preview
    stepper.screenshot("display_quads")
    finest = levels.level_of(preview)
    held("WHEELDOWNMOUSE", ctrl=True)
    yield 0.5
    assert levels.level_of(preview) == finest - 1
    held("PAGE_UP")
    yield 0.5
    assert levels.level_of(preview) == finest
    held("W", ctrl=True, alt=True)
    yield 2
    assert display.mode == "SHADED" and not preview.show_wire
    stepper.screenshot("display_shaded")
    shading = stepper.view()["space_data"].shading
    for mode in ("PATCHES", "STRETCH", "ERROR"):
        with bpy.context.temp_override(**stepper.view()):
            display.mode = mode
        assert (shading.type, shading.color_type) == ("SOLID", "VERTEX")
        yield 2
        stepper.screenshot(f"display_{mode.lower()}")
    assert len(legend.lines(bpy.context)) == 6
    with bpy.context.temp_override(**stepper.view()):
        display.mode = "QUADS"
    assert shading.color_type == "MATERIAL"
    yield 0.5


stepper.run(steps)
