# SPDX-License-Identifier: GPL-3.0-or-later
"""What keys and the wheel do in the 3D view."""

import bpy
from bpy.props import IntProperty

from ...bridge import levels, view
from . import properties


class HYBRID_MESH_OT_toggle_quads(bpy.types.Operator):
    """Show or hide the edges of the quads"""

    bl_idname = "hybrid_mesh.toggle_quads"
    bl_label = "Show Quads"
    bl_options = {"REGISTER", "INTERNAL"}

    @classmethod
    def poll(cls, context):
        return properties.shown_hierarchy(context) is not None

    def execute(self, context):
        values = context.scene.hybrid_mesh_display
        if values.mode in ("SHADED", "QUADS"):
            values.mode = "SHADED" if values.mode == "QUADS" else "QUADS"
        else:
            values.edges = not values.edges
        return {"FINISHED"}


class HYBRID_MESH_OT_step_level(bpy.types.Operator):
    """Show the next finer or coarser level in the preview"""

    bl_idname = "hybrid_mesh.step_level"
    bl_label = "Step Level"
    bl_options = {"INTERNAL"}

    step: IntProperty(name="Step", description="Levels, finer ones if positive", default=1, min=-100, max=100)

    @classmethod
    def poll(cls, context):
        collection = properties.shown_hierarchy(context)
        preview = collection.hybrid_mesh.preview if collection is not None else None
        return preview is not None and levels.shown_object(preview) is not None

    def execute(self, context):
        preview = properties.shown_hierarchy(context).hybrid_mesh.preview
        levels.set_level(preview, min(max(levels.level_of(preview) + self.step, 0), levels.count(preview) - 1))
        view.redraw(context)
        return {"FINISHED"}


# (key, what is held with it, operator, its properties). Where an operator does not poll, the key does what it does without the add-on.
_KEYS = (
    ("WHEELUPMOUSE", {"ctrl": True}, "hybrid_mesh.step_level", {"step": 1}),
    ("WHEELDOWNMOUSE", {"ctrl": True}, "hybrid_mesh.step_level", {"step": -1}),
    ("PAGE_UP", {}, "hybrid_mesh.step_level", {"step": 1}),
    ("PAGE_DOWN", {}, "hybrid_mesh.step_level", {"step": -1}),
    ("W", {"ctrl": True, "alt": True}, "hybrid_mesh.toggle_quads", {}),
)
_made = []


def register():
    configuration = bpy.context.window_manager.keyconfigs.addon
    if configuration is None:  # in the background
        return
    keymap = configuration.keymaps.new(name="3D View", space_type="VIEW_3D")
    for key, held, operator, values in _KEYS:
        item = keymap.keymap_items.new(operator, key, "PRESS", **held)
        for name, value in values.items():
            setattr(item.properties, name, value)
        _made.append((keymap, item))


def unregister():
    for keymap, item in _made:
        keymap.keymap_items.remove(item)
    _made.clear()
