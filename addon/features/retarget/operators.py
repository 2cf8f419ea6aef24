# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from ..levels import made
from ..levels.making import MakingOperator
from ..levels.properties import origin_of
from . import rig


class HYBRID_MESH_OT_retarget(MakingOperator):
    """Have what was made of a hybrid mesh (by Make Mesh, Convert to Multires, Bake) move as its source does: with its armature, vertex groups and shape keys. Of a hybrid mesh itself an ordinary mesh is made first"""

    bl_idname = "hybrid_mesh.retarget"
    bl_label = "Retarget"
    bl_options = {"REGISTER", "UNDO"}

    def chosen(self, context):
        """Objects that were made of hierarchies, and the other hierarchies."""
        objects = sorted((obj for obj in context.view_layer.objects.selected if origin_of(obj) is not None), key=lambda obj: obj.name)
        given = {origin_of(obj) for obj in objects}
        return [*objects, *(collection for collection in made.chosen_hierarchies(context) if collection not in given)]

    def work(self, context, one):
        return rig.retarget(context, one) if isinstance(one, bpy.types.Object) else self._of_hierarchy(context, one)

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
