# SPDX-License-Identifier: GPL-3.0-or-later
"""A level as an ordinary mesh object."""

import bpy
from bpy.props import EnumProperty

from ...bridge import objects, view
from . import made
from .properties import hierarchy_of

LEVELS = (
    ("SHOWN", "Shown Level", "The level that the preview shows"),
    ("FINAL", "Final Mesh", "The finest level"),
)


class HYBRID_MESH_OT_make_mesh(bpy.types.Operator):
    """Make an ordinary mesh object of the level that is shown, with all that its surface carries, without modifiers"""

    bl_idname = "hybrid_mesh.make_mesh"
    bl_label = "Make Mesh"
    bl_options = {"REGISTER", "UNDO"}

    level: EnumProperty(name="Level", description="Which level it is made of", items=LEVELS, default="SHOWN")

    @classmethod
    def poll(cls, context):
        if hierarchy_of(objects.active(context)) is None:
            cls.poll_message_set("Make a hybrid mesh the active object: a level, the preview, or the object that was remeshed")
            return False
        return True

    def execute(self, context):
        view.to_object_mode(context)  # What is edited in another mode is not in the mesh yet.
        collection = hierarchy_of(objects.active(context))
        level = made.shown_level(collection) if self.level == "SHOWN" else made.finest_level(collection)
        if level is None:
            self.report({"ERROR"}, f"{collection.name}: the object of that level is gone")
            return {"CANCELLED"}
        obj = made.make_object(context, collection, level.data.copy(), "_quads", level.hybrid_mesh.level)
        view.select_only(context, obj)
        self.report({"INFO"}, f"{obj.name}: {len(obj.data.vertices):,} vertices, of {level.name}")
        return {"FINISHED"}
