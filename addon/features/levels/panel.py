# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from ...bridge import levels
from ...core import report as reports
from ..wrapping import draw_wrapped
from . import properties, streams


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
        if preview is not None:
            levels.draw_level(layout, preview)
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
        self._quality(layout, properties.quality_of(collection))
        self._levels(layout, report)

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

    def _quality(self, layout, quality):
        column = layout.column(align=True)
        for label, text in quality_lines(quality):
            row = column.split(factor=0.5)
            row.label(text=label)
            row.label(text=text)

    def _levels(self, layout, report):
        if not report.get("levels"):
            return
        box = layout.box().column(align=True)
        for level in report["levels"]:
            row = box.row()
            name = level.get("level")
            row.label(text=name if isinstance(name, str) else f"N{name}")
            row.label(text=f"{level.get('vertices', 0):,}")
            row.label(text=_fraction(level.get("l2")))


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
