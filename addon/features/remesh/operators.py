# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import BoolProperty, EnumProperty

from ...bridge import objects
from ...core import settings as core
from ..topology import properties as topology_properties
from .job import RemeshJobOperator, remesh_task
from .properties import RemeshProperties, apply_settings, core_settings, draw_advanced, draw_settings


class HYBRID_MESH_OT_remesh(RemeshProperties, RemeshJobOperator):
    """Make a hierarchy of quad meshes of each selected mesh object. The source stays as it is"""

    bl_idname = "hybrid_mesh.remesh"
    bl_label = "Remesh to Hybrid Mesh"
    bl_options = {"REGISTER", "UNDO"}

    hide_source: BoolProperty(name="Hide Source", description="Hide the source in the viewport, so that the result is seen", default=False)

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Works in Object Mode")
            return False
        if not any(obj.type == "MESH" for obj in context.selected_objects):
            cls.poll_message_set("Select a mesh object")
            return False
        return True

    def draw(self, context):
        draw_settings(self.layout, self)
        draw_advanced(self.layout, self)
        self.layout.prop(self, "hide_source")

    def prepare(self, context):
        settings = core_settings(self)
        graph = context.evaluated_depsgraph_get()
        chosen = sorted((obj for obj in context.selected_objects if obj.type == "MESH"), key=lambda obj: obj.name)
        if not chosen:
            raise ValueError("No mesh object is selected")
        return [remesh_task(obj, graph, settings) for obj in chosen]

    def finish(self, context, results):
        super().finish(context, results)
        for task, result in results:
            source = task.note[0]
            topology_properties.say_later(self, objects.find(context.scene, source.key), source, result.plan)

    def hides_source(self, context):
        return self.hide_source


class HYBRID_MESH_OT_preset(bpy.types.Operator):
    """Set the remesh settings of the scene to a preset"""

    bl_idname = "hybrid_mesh.preset"
    bl_label = "Remesh Preset"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    name: EnumProperty(name="Preset", items=[(key.upper(), label, text) for key, (label, text, _) in core.PRESETS.items()])

    def execute(self, context):
        apply_settings(context.scene.hybrid_mesh, core.preset(self.name.lower()))
        return {"FINISHED"}
