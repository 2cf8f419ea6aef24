# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from ...bridge import view
from ...core.native import expected, explain
from ..levels import made
from ..levels.properties import origin_of
from . import rig


class HYBRID_MESH_OT_retarget(bpy.types.Operator):
    """Have what was made of a hybrid mesh (by Make Mesh, Convert to Multires, Bake) move as its source does: with its armature, vertex groups and shape keys. Of a hybrid mesh itself an ordinary mesh is made first"""

    bl_idname = "hybrid_mesh.retarget"
    bl_label = "Retarget"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if not made.chosen_hierarchies(context):
            cls.poll_message_set("Select what was made of hybrid meshes, or hybrid meshes")
            return False
        return True

    def execute(self, context):
        view.to_object_mode(context)  # What is edited in another mode is not in the mesh yet.
        done, errors = [], []
        chosen = sorted((obj for obj in context.view_layer.objects.selected if origin_of(obj) is not None), key=lambda obj: obj.name)
        given = {origin_of(obj) for obj in chosen}
        with view.waiting(context):
            for one in (*chosen, *(collection for collection in made.chosen_hierarchies(context) if collection not in given)):
                try:
                    done.append(rig.retarget(context, one) if isinstance(one, bpy.types.Object) else self._of_hierarchy(context, one))
                except Exception as error:
                    if not expected(error):
                        raise
                    errors.append(explain(error))
        if done:
            view.select_only(context, *(one.obj for one in done))
        for one in done:
            self.report({"INFO"}, one.line())
        if errors:
            self.report({"ERROR"}, "\n".join(errors))
        return {"FINISHED"} if done else {"CANCELLED"}

    def _of_hierarchy(self, context, collection):
        level = made.finest_level(collection)
        if level is None:
            raise ValueError(f"{collection.name}: its levels are gone")
        obj = made.make_object(context, collection, level.data.copy(), "_quads", level.hybrid_mesh.level)
        try:
            context.view_layer.update()
            return rig.retarget(context, obj)
        except BaseException:
            made.remove(obj)
            raise
