# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import BoolProperty, IntProperty

from ...bridge import levels, objects, view
from ...core import report as reports
from ...core.native import expected, explain
from . import editing
from .properties import hierarchy_of, is_level, place_of, report_of

_SHOWN = 0.02  # of a hierarchy's diagonal: what look_at() is to show


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


class HYBRID_MESH_OT_show_reason(bpy.types.Operator):
    """Put the 3D cursor where the result is poor, and look at it"""

    bl_idname = "hybrid_mesh.show_reason"
    bl_label = "Show Reason"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    index: IntProperty(name="Reason", description="Of the verdict on the hierarchy, from 0 on", min=0, default=0)

    @classmethod
    def poll(cls, context):
        return hierarchy_of(objects.active(context)) is not None

    def execute(self, context):
        collection = hierarchy_of(objects.active(context))
        reasons = reports.reasons(report_of(collection))
        if self.index >= len(reasons):
            self.report({"ERROR"}, f"{collection.name}: there are {len(reasons)} reasons against the result, and no number {self.index}")
            return {"CANCELLED"}
        where = reasons[self.index].get("where")
        if where is None:
            self.report({"ERROR"}, f"This has no place: {reasons[self.index]['text']}")
            return {"CANCELLED"}
        context.scene.cursor.location = place = place_of(collection, where)
        preview = collection.hybrid_mesh.preview
        if preview is None or not view.look_at(context, preview, place, _SHOWN * objects.diagonal(preview)):
            self.report({"INFO"}, "There is no 3D view to turn; the 3D cursor is at the place")
        return {"FINISHED"}


class _EditingOperator(bpy.types.Operator):
    """Base of what is done to the active level. Subclasses have work(obj), which returns a line for people and changes nothing if it raises."""

    @classmethod
    def poll(cls, context):
        if not is_level(objects.active(context)):
            cls.poll_message_set("Make a level of a hierarchy the active object")
            return False
        return True

    def work(self, obj):
        raise NotImplementedError

    def execute(self, context):
        # What is edited in another mode is not in the mesh yet; and undo in Edit Mode knows nothing of the other levels.
        view.to_object_mode(context)
        try:
            line = self.work(objects.active(context))
        except Exception as error:
            if not expected(error):
                raise
            self.report({"ERROR"}, explain(error))
            return {"CANCELLED"}
        self.report({"INFO"}, line)
        return {"FINISHED"}


class HYBRID_MESH_OT_update_levels(_EditingOperator):
    """Carry what was edited of this level to the finer levels and the preview. They keep their details, which turn with the surface"""

    bl_idname = "hybrid_mesh.update_levels"
    bl_label = "Update Levels"
    bl_options = {"REGISTER", "UNDO"}

    coarser: BoolProperty(name="Coarser Levels Too", description="The coarser levels follow as well", default=False)

    def work(self, obj):
        changed = editing.update(obj, self.coarser)
        return f"{obj.name}: {'one other level has' if changed == 1 else f'{changed} other levels have'} followed"


class HYBRID_MESH_OT_reset_level(_EditingOperator):
    """Take back what was edited of this level since the levels were last updated"""

    bl_idname = "hybrid_mesh.reset_level"
    bl_label = "Reset Level"
    bl_options = {"REGISTER", "UNDO"}

    def work(self, obj):
        if not editing.reset(obj):
            raise ValueError(f"{obj.name} is as it was: there is nothing to take back")
        return f"{obj.name} is as it was"
