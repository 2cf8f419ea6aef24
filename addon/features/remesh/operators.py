# SPDX-License-Identifier: GPL-3.0-or-later
import json

import bpy
from bpy.props import BoolProperty, EnumProperty

from ...bridge import arrays, levels, meshes, placement, transfer
from ...core import settings as core
from ...core.native import native
from ...core.tasks import Task
from ...core.version import VERSION
from ...jobs import NativeJobOperator
from ..levels import properties as hierarchy_properties
from .properties import RemeshProperties, apply_settings, core_settings, draw_advanced, draw_settings


class HYBRID_MESH_OT_remesh(RemeshProperties, NativeJobOperator):
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
        module = native()
        graph = context.evaluated_depsgraph_get()
        tasks = []
        for obj in sorted((obj for obj in context.selected_objects if obj.type == "MESH"), key=lambda obj: obj.name):
            try:
                source = meshes.read_source(obj, graph, transfer.collect)
            except (meshes.SourceError, arrays.MatrixError) as error:
                tasks.append(Task(obj.name, _refusal(error)))
                continue
            tasks.append(Task(obj.name, _starter(module, source.mesh, settings), (source, settings)))
        if not tasks:
            raise ValueError("No mesh object is selected")
        return tasks

    def finish(self, context, results):
        # Everything is looked up by name again: objects may have gone while the work ran.
        sources = []
        for task, _ in results:
            if task.name not in context.scene.objects:
                raise ValueError(f"{task.name}: the object is gone from the scene; nothing was made")
            sources.append(context.scene.objects[task.name])
        built = [_build(context, obj, result, *task.note) for obj, (task, result) in zip(sources, results, strict=True)]
        _select(context, [one.preview for one in built])
        if self.hide_source:
            for obj in sources:
                obj.hide_set(True)
        for one in built:
            self.report({"INFO"}, _line(one))
        for task, result in results:
            for warning in json.loads(result.report).get("warnings", []):
                self.report({"WARNING"}, f"{task.name}: {warning}")


class HYBRID_MESH_OT_preset(bpy.types.Operator):
    """Set the remesh settings of the scene to a preset"""

    bl_idname = "hybrid_mesh.preset"
    bl_label = "Remesh Preset"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    name: EnumProperty(name="Preset", items=[(key.upper(), label, text) for key, (label, text, _) in core.PRESETS.items()])

    def execute(self, context):
        apply_settings(context.scene.hybrid_mesh, core.preset(self.name.lower()))
        return {"FINISHED"}


def _starter(module, mesh, settings):
    return lambda: module.start_remesh(*mesh, settings.native())


def _refusal(error):
    """A start that fails: the object is named among the errors, and the others are done."""

    def start():
        raise error

    return start


def _build(context, obj, result, source, settings):
    hierarchy = result.hierarchy
    parts = [(name, hierarchy.level(name)) for name in hierarchy.level_names]
    carry = transfer.carrier(source, result.repaired())
    built = levels.build(obj.name, parts, source.matrix, context.scene, placement.same_place(obj), obj, carry)
    report = json.loads(result.report)
    report["version"] = VERSION
    report["settings"] = settings.reported()
    hierarchy_properties.describe(built, obj, report)
    levels.show_preview_only(built)
    return built


def _select(context, objects):
    for obj in context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    context.view_layer.objects.active = objects[-1]


def _line(built):
    quality = hierarchy_properties.quality_of(built.collection)
    figures = [f"{quality['vertices']:,} vertices"] if quality["vertices"] is not None else []
    if quality["l2"] is not None:
        figures.append(f"L2 {quality['l2']:.2e}")
    return f"{built.collection.name}: {', '.join([f'{len(built.levels)} levels', *figures])}"
