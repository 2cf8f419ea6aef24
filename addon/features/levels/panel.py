# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from ...bridge import levels, units
from ...core import readout
from ...core import report as reports
from ..display import coloring
from ..display import panel as display_panel
from ..wrapping import draw_wrapped
from . import made, properties, streams


class HYBRID_MESH_PT_levels(bpy.types.Panel):
    bl_idname = "HYBRID_MESH_PT_levels"
    bl_label = "Levels"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Hybrid Mesh"
    bl_order = 1

    @classmethod
    def poll(cls, context):
        return properties.hierarchy_of(context.object) is not None or properties.origin_of(context.object) is not None

    def draw(self, context):
        layout = self.layout
        collection = properties.hierarchy_of(context.object)
        if collection is None:
            origin = properties.origin_of(context.object)
            layout.label(text=f"Made of {origin.name}, {context.object.hybrid_mesh.made_level}", icon="OUTLINER_COLLECTION")
            column = layout.column(align=True)
            column.operator("hybrid_mesh.retarget")
            column.operator("hybrid_mesh.bake")
            return
        report = properties.report_of(collection)
        layout.label(text=collection.name, icon="OUTLINER_COLLECTION")
        preview = collection.hybrid_mesh.preview
        level = _read_level(context, collection)
        display_panel.draw_show(layout, context.scene.hybrid_mesh_display)
        if preview is not None:
            row = layout.row(align=True)
            levels.draw_level(row, preview)
            row.operator("hybrid_mesh.step_level", text="", icon="REMOVE").step = -1
            row.operator("hybrid_mesh.step_level", text="", icon="ADD").step = 1
        if properties.is_level(context.object):
            row = layout.row(align=True)
            row.operator("hybrid_mesh.update_levels")
            row.operator("hybrid_mesh.reset_level")
        self._stream(layout, collection)
        column = layout.column(align=True)
        column.operator("hybrid_mesh.make_mesh")
        column.operator("hybrid_mesh.convert_to_multires")
        column.operator("hybrid_mesh.bake")
        column.operator("hybrid_mesh.retarget")
        self._verdict(context, layout, report)
        if level is not None:
            self._readout(context, layout, collection, level)

    def _readout(self, context, layout, collection, level):
        """What is to be said of the level that is shown."""
        name, finest = level.hybrid_mesh.level, level == made.finest_level(collection)
        column = layout.box().column(align=True)
        column.label(text=f"{name}: {len(level.data.polygons):,} faces", icon="MESH_GRID")
        column.label(text=f"{len(level.data.vertices):,} vertices")
        figures = readout.figures_of(properties.report_of(collection), name, finest)
        for line in readout.lines(figures, coloring.diagonal_of(collection), lambda length: units.length_text(context.scene, length)):
            draw_wrapped(context, column, line)

    def _stream(self, layout, collection):
        if not streams.has_stream(collection):
            return
        stream = collection.hybrid_mesh_stream
        row = layout.split(factor=0.6)
        row.enabled = streams.is_shown(collection)
        row.prop(stream, "bytes")
        row.label(text=f"of {stream.size:,}" if row.enabled else "edited since")

    def _verdict(self, context, layout, report):
        if reports.verdict(report) == "good":
            layout.label(text="Good", icon="CHECKMARK")
        for index, reason in enumerate(reports.reasons(report)):
            box = layout.box()
            row = box.row()
            row.label(text="Poor", icon="ERROR")
            if "where" in reason:
                row.operator("hybrid_mesh.show_reason", text="", icon="VIEWZOOM", emboss=False).index = index
            draw_wrapped(context, box, reason["text"])


class HYBRID_MESH_PT_figures(bpy.types.Panel):
    bl_idname = "HYBRID_MESH_PT_figures"
    bl_label = "Figures"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Hybrid Mesh"
    bl_parent_id = "HYBRID_MESH_PT_levels"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return properties.hierarchy_of(context.object) is not None

    def draw(self, context):
        collection = properties.hierarchy_of(context.object)
        column = self.layout.column(align=True)
        for label, text in quality_lines(properties.quality_of(collection)):
            row = column.split(factor=0.5)
            row.label(text=label)
            row.label(text=text)
        box = self.layout.box().column(align=True)
        for name, vertices, distance in level_rows(collection):
            row = box.row()
            row.label(text=name)
            row.label(text=f"{vertices:,}")
            row.label(text=distance)


def level_rows(collection):
    """(name, vertices, L2 where it was measured) of the levels that are there, also of those before an operation."""
    report = properties.report_of(collection)
    rows = []
    for obj in sorted(coloring.level_objects(collection), key=lambda obj: (properties.level_number(obj.hybrid_mesh.level), obj.hybrid_mesh.level)):
        name = obj.hybrid_mesh.level
        rows.append((name, len(obj.data.vertices), _fraction(readout.figures_of(report, name, False).get("l2"))))
    return rows


def _read_level(context, collection):
    """The level that is read out: the active object, if it is one, else the one that the preview shows."""
    return context.object if properties.is_level(context.object) else made.shown_level(collection)


def quality_lines(quality):
    """(label, text) of the read-out, without what was not measured."""
    lines = [
        ("Vertices", _count(quality["vertices"])),
        ("Quads", _count(quality["quads"])),
        ("L2", _fraction(quality["l2"])),
        ("Hausdorff", _fraction(quality["hausdorff"])),
        ("Irregular vertices", _count(quality["irregular_vertices"])),
        ("Scaled Jacobian, 5 %", _plain(quality["scaled_jacobian_p05"])),
        ("Scaled Jacobian, median", _plain(quality["scaled_jacobian_p50"])),
        ("Inverted quads", _percent(quality["inverted"])),
        ("Self-intersections", _count(quality["self_intersections"])),
    ]
    return [(label, text) for label, text in lines if text]


def _count(value):
    return "" if value is None else f"{value:,}"


def _fraction(value):
    return "" if value is None else f"{value:.2e}"


def _plain(value):
    return "" if value is None else f"{value:.3f}"


def _percent(value):
    return "" if value is None else f"{value:.3%}"
