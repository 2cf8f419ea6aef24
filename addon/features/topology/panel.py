# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from . import properties

# Widths of the list's columns, as fractions of what is left.
_KIND, _LENGTH = 0.42, 0.42


class HYBRID_MESH_UL_loops(bpy.types.UIList):
    bl_idname = "HYBRID_MESH_UL_loops"

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        split = layout.split(factor=_KIND)
        split.label(text=item.bl_rna.properties["kind"].enum_items[item.kind].name, icon="GREASEPENCIL" if item.drawn else "CURVE_NCIRCLE")
        split = split.split(factor=_LENGTH)
        split.label(text=f"{item.length:.1%}")
        row = split.row(align=True)
        level = row.row(align=True)
        level.active = item.use
        level.prop(item, "level", text="", emboss=False)
        row.prop(item, "use", text="")


class HYBRID_MESH_PT_topology(bpy.types.Panel):
    bl_idname = "HYBRID_MESH_PT_topology"
    bl_label = "Topology"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Hybrid Mesh"
    bl_order = 3

    @classmethod
    def poll(cls, context):
        return properties.surface_of(context.object, context.scene) is not None

    def draw(self, context):
        layout = self.layout
        surface = properties.surface_of(context.object, context.scene)
        layout.label(text=surface.name, icon="MESH_DATA")
        layout.operator("hybrid_mesh.find_loops", icon="VIEWZOOM")
        if len(properties.loops_of(surface)):
            self._list(layout, surface.hybrid_mesh_topology)
        column = layout.column(align=True)
        column.operator("hybrid_mesh.draw_layout", text="Draw Strokes", icon="GREASEPENCIL")
        column.operator("hybrid_mesh.draw_loop", icon="CURVE_NCIRCLE")

    def _list(self, layout, values):
        split = layout.split(factor=_KIND)
        split.label(text="Around")
        split = split.split(factor=_LENGTH)
        split.label(text="Length")
        split.label(text="Level")
        layout.template_list("HYBRID_MESH_UL_loops", "", values, "loops", values, "index", rows=min(len(values.loops), 6))
        row = layout.row(align=True)
        row.operator("hybrid_mesh.remove_loop", text="Remove", icon="REMOVE")
        row.operator("hybrid_mesh.clear_loops", icon="X")
