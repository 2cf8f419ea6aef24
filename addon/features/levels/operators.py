# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import IntProperty

from ...bridge import levels
from .properties import hierarchy_of


class HYBRID_MESH_OT_show_level(bpy.types.Operator):
    """Show a level of the hierarchy in its preview object"""

    bl_idname = "hybrid_mesh.show_level"
    bl_label = "Show Level"
    bl_options = {"REGISTER", "UNDO"}

    level: IntProperty(name="Level", description="0 is the coarsest", min=0, default=0)

    @classmethod
    def poll(cls, context):
        collection = hierarchy_of(context.object)
        return collection is not None and collection.hybrid_mesh.preview is not None

    def execute(self, context):
        preview = hierarchy_of(context.object).hybrid_mesh.preview
        if levels.PREVIEW_MODIFIER not in preview.modifiers:
            self.report({"ERROR"}, f"{preview.name} has no modifier {levels.PREVIEW_MODIFIER} any more")
            return {"CANCELLED"}
        levels.set_level(preview, self.level)
        return {"FINISHED"}
