# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import BoolProperty, EnumProperty

from ...bridge import objects
from ...core import settings as core
from ..layouts import properties as layout_properties
from ..levels import properties as hierarchy_properties
from ..topology import properties as topology_properties
from .job import RemeshJobOperator, remesh_task
from .properties import RemeshProperties, RemeshSwitches, apply_settings, core_settings, draw_advanced, draw_settings


class HYBRID_MESH_OT_remesh(RemeshSwitches, RemeshProperties, RemeshJobOperator):
    """Make a hierarchy of quad meshes of each selected mesh object; of previews, levels and layouts, their source is remeshed. The source stays as it is"""

    bl_idname = "hybrid_mesh.remesh"
    bl_label = "Remesh to Hybrid Mesh"
    bl_options = {"REGISTER", "UNDO"}

    hide_source: BoolProperty(name="Hide Source", description="Hide the source in viewports and renders, so that the result is seen in its place", default=False)

    @classmethod
    def poll(cls, context):
        if context.mode != "OBJECT":
            cls.poll_message_set("Works in Object Mode")
            return False
        if not any(_source_of(obj, context.scene) for obj in context.view_layer.objects.selected):
            cls.poll_message_set("Select a mesh object")
            return False
        return True

    def draw(self, context):
        draw_settings(self.layout, self)
        draw_advanced(self.layout, self)
        self.layout.prop(self, "hide_source")

    def prepare(self, context):
        settings = core_settings(self)
        sources = {}
        for obj in sorted(context.view_layer.objects.selected, key=lambda obj: obj.name):
            source = _source_of(obj, context.scene)
            if source is not None:
                sources.setdefault(objects.key_of(source), (source, []))[1].append(obj)
        if not sources:
            raise ValueError("No mesh object is selected")
        tasks = []
        for source, chosen in sorted(sources.values(), key=lambda one: one[0].name):
            if source not in chosen:
                self.report({"INFO"}, f"{', '.join(obj.name for obj in chosen)}: {source.name}, the source, is remeshed")
            with objects.evaluated(context, source) as graph:
                tasks.append(remesh_task(source, graph, settings))
        return tasks

    def finish(self, context, results):
        super().finish(context, results)
        for task, result in results:
            source = task.note[0]
            topology_properties.say_later(self, objects.find(context.scene, source.key), source, result.plan)

    def hides_source(self, context):
        return self.hide_source


def _source_of(obj, scene):
    """The mesh object that is remeshed where an object is selected: of a preview, a level or a layout, what they were made of, if it is there; or None."""
    surface = layout_properties.surface_of(obj, scene)
    if hierarchy_properties.is_level(surface):
        source = surface.hybrid_mesh.hierarchy.hybrid_mesh.source
        if source is not None and source.type == "MESH" and objects.in_scene(source, scene):
            return source
    if surface is not None:
        return surface if surface.type == "MESH" else None
    return obj if obj.type == "MESH" else None


class HYBRID_MESH_OT_preset(bpy.types.Operator):
    """Set the remesh settings of the scene to a preset"""

    bl_idname = "hybrid_mesh.preset"
    bl_label = "Remesh Preset"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    name: EnumProperty(
        name="Preset",
        items=[(key.upper(), f"{label}: {core.preset_summary(key)}", text) for key, (label, text, _) in core.PRESETS.items()],
    )

    @classmethod
    def description(cls, context, properties):
        return f"{core.PRESETS[properties.name.lower()][1]}. Sets {core.preset_summary(properties.name.lower())}; all other settings as they are at first"

    def execute(self, context):
        apply_settings(context.scene.hybrid_mesh, core.preset(self.name.lower()))
        return {"FINISHED"}
