# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of a level that are laid out anew."""

import bpy
import numpy
from bpy.props import EnumProperty

from ...bridge import objects, view
from ...core import plans
from ...core import settings as core
from ..levels import hierarchies
from ..levels import properties as hierarchy_properties
from ..remesh.job import RemeshJobOperator, build_hierarchy, remesh_task
from ..remesh.properties import core_settings
from . import drawing, problems, properties, region_quads, region_update

_sources = []  # Blender keeps no reference to the texts of items that a function returns.


def _source_items(operator, context):
    """The operations of the active object's hierarchy whose layout can be copied."""
    surface = properties.surface_of(objects.active(context), context.scene) if context is not None else None
    hierarchy = hierarchy_properties.hierarchy_of(surface if properties.is_level(surface) else objects.active(context)) if context is not None else None
    found = hierarchy_properties.operations_of(hierarchy) if hierarchy is not None else []
    choices = [(number, one) for number, one in enumerate(found) if one["corners"]]
    _sources[:] = [
        (str(number), f"Level {one['level']}: {len(one['quads'])} quads to {len(one['new_quads'])}, {one['corners']} sides", "Copy the layout of this operation", place)
        for place, (number, one) in enumerate(choices)
    ] or [("NONE", "None", "The hierarchy has no operation whose layout can be copied", 0)]
    return _sources


class HYBRID_MESH_OT_repatch_region(properties.RegionProperties, RemeshJobOperator):
    """Lay out the selected faces of a level anew, along curves drawn over them, or by a rule. All that is farther off stays as it is"""

    bl_idname = "hybrid_mesh.repatch_region"
    bl_label = "Repatch Region"
    bl_options = {"REGISTER", "UNDO"}

    source: EnumProperty(name="Operation", description="The operation whose layout is copied", items=_source_items)

    _level = _hierarchy = None  # objects.key_of() them
    _drawn = None  # drawing.Drawn, if curves were drawn
    _finest = 0  # number of the finest level that there was
    _update = None  # region_update.Update, where the hierarchy is at hand

    @classmethod
    def poll(cls, context):
        if not properties.is_level(properties.surface_of(objects.active(context), context.scene)):
            cls.poll_message_set("Make a level of a hierarchy, or the layout drawn on it, the active object")
            return False
        return True

    def draw(self, context):
        properties.draw_region(self.layout, self)
        if self.layout_kind == "COPY":
            self.layout.prop(self, "source")

    def prepare(self, context):
        self._drawn, self._finest = None, 0
        level = properties.surface_of(objects.active(context), context.scene)
        hierarchy = level.hybrid_mesh.hierarchy
        source = hierarchy.hybrid_mesh.source
        if hierarchy.hybrid_mesh.file:
            raise ValueError(f"{hierarchy.name} was imported: there is no object that it was made of to lay the region out on")
        if source is None or not objects.in_scene(source, context.scene):
            raise ValueError(f"{hierarchy.name}: the object that it was made of is gone from the scene")
        for block in (hierarchy, *region_quads.levels_of(hierarchy)):
            if not objects.is_local(block):
                raise ValueError(f"{block.name} comes of a library and cannot be changed")
        plan = hierarchy_properties.plan_of(hierarchy)
        if not plan:
            raise ValueError(f"{hierarchy.name} has no plan; remesh {source.name} again")
        addresses = region_quads.selected_quads(level, hierarchy)
        operation = plans.repatch_operation(region_quads.level_number(level), addresses, self._new_layout(context, level, hierarchy), self.buffer_rings)
        self._level, self._hierarchy = objects.key_of(level), objects.key_of(hierarchy)
        self._update = region_update.prepare(hierarchy, operation, plan)
        if self._update is not None:
            return [self._update.task(source.name)]
        with objects.evaluated(context, source) as graph:
            return [remesh_task(source, graph, _settings_of(hierarchy, context.scene), plans.with_operation(plan, operation))]

    def _new_layout(self, context, level, hierarchy):
        if self.layout_kind == "AUTOMATIC" or (self.layout_kind == "DRAWN" and not drawing.has_strokes(context, level)):
            return plans.automatic_layout()
        if self.layout_kind == "CUBES":
            return plans.cubes_layout(self.height)
        if self.layout_kind == "ROWS":
            return plans.rows_layout(self.height)
        if self.layout_kind == "EVEN":
            return plans.even_layout(self.even_quads)
        if self.layout_kind == "COPY":
            return region_quads.copied_layout(level, hierarchy, self.source, self.turn)
        self._drawn = drawn = drawing.read_drawn(context, level)
        for stroke in drawn.strokes:
            if not numpy.isfinite(stroke.points).all():
                raise ValueError(f"{drawn.layout[0]}: {problems.named('a stroke has points that are not finite', stroke)}")
        return plans.drawn_layout([(stroke.points, fit) for stroke, fit in zip(drawn.strokes, drawn.fits, strict=True)])

    def finish(self, context, results):
        view.to_object_mode(context)
        if self._update is not None:
            ((task, outcome),) = results
            results = [(task, self._update.result(outcome))]
        super().finish(context, results)
        level = objects.find(context.scene, self._level)
        if level is not None:
            layout = objects.find(context.scene, self._drawn.layout) if self._drawn is not None else properties.layout_of(level, context.scene)
            if layout is not None:
                drawing.forget_problems(context, level, layout)
            drawing.hide(context, level)
        _, settings = results[0][0].note
        lost = self._finest - region_quads.finest_level(objects.active(context).hybrid_mesh.hierarchy)
        if lost > 0 and settings.vertices:
            self.report({"WARNING"}, f"With the new quads the bound of {settings.vertices:,} vertices leaves {'one level' if lost == 1 else f'{lost} levels'} less")

    def build(self, context, obj, result, source, settings):
        built = build_hierarchy(context, obj, result, source, settings)
        hierarchy = bpy.data.collections.get(self._hierarchy)
        if hierarchy is None:
            return built
        self._finest = region_quads.finest_level(hierarchy)
        return hierarchies.take_over(built, hierarchy)

    def failed(self, context, task, error):
        problems.show_failure(context, self._level, self._drawn, error)

    def hides_source(self, context):
        return False


def _settings_of(hierarchy, scene):
    """The settings that a hierarchy was made with: another region is no reason for another size. The scene's, if they are not known."""
    recorded = hierarchy_properties.report_of(hierarchy).get("settings")
    given = core_settings(scene.hybrid_mesh)
    if not isinstance(recorded, dict):
        return given
    return core.from_mapping({**recorded, "threads": given.threads})
