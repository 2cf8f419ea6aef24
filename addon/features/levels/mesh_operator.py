# SPDX-License-Identifier: GPL-3.0-or-later
"""A level as an ordinary mesh object."""

import bpy
from bpy.props import EnumProperty

from ...bridge import levels, objects, placement, view
from ...bridge.names import with_suffix
from .properties import hierarchy_of, is_level, level_number, name_of

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
        level = _level_object(collection, self.level)
        if level is None:
            self.report({"ERROR"}, f"{collection.name}: the object of that level is gone")
            return {"CANCELLED"}
        name = with_suffix(name_of(collection), "_quads")
        mesh = level.data.copy()
        mesh.name = name
        obj = bpy.data.objects.new(name, mesh)
        _collection_around(context, collection).objects.link(obj)
        # The preview is what is seen of a hierarchy, and may have been moved by itself.
        placement.same_place(collection.hybrid_mesh.preview or level)(obj)
        view.select_only(context, obj)
        self.report({"INFO"}, f"{obj.name}: {len(mesh.vertices):,} vertices, of {level.name}")
        return {"FINISHED"}


def _level_object(collection, level):
    """The object of a level, or None where it is gone."""
    preview = collection.hybrid_mesh.preview
    if level == "SHOWN":
        shown = levels.shown_object(preview) if preview is not None else None
        return shown if is_level(shown) else None
    return max((obj for obj in collection.objects if is_level(obj)), key=lambda obj: level_number(obj.hybrid_mesh.level), default=None)


def _collection_around(context, collection):
    """The collection that a hierarchy is in."""
    scene = context.scene.collection
    return next((one for one in (scene, *scene.children_recursive) if collection in one.children.values()), scene)
