# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from ... import compat, jobs
from .properties import SETTING_NAMES, draw_advanced, draw_settings


class HYBRID_MESH_PT_remesh(bpy.types.Panel):
    bl_idname = "HYBRID_MESH_PT_remesh"
    bl_label = "Remesh"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Hybrid Mesh"
    bl_order = 0

    def draw(self, context):
        layout = self.layout
        if jobs.running():
            compat.draw_progress(layout.box(), *jobs.progress())
        settings = context.scene.hybrid_mesh
        layout.operator_menu_enum("hybrid_mesh.preset", "name", text="Presets")
        draw_settings(layout.column(), settings)
        layout.prop(settings, "hide_source")
        column = layout.column()
        column.scale_y = 1.4
        operator = column.operator("hybrid_mesh.remesh", text="Remesh", icon="MOD_REMESH")
        for name in (*SETTING_NAMES, "hide_source"):
            setattr(operator, name, getattr(settings, name))


class HYBRID_MESH_PT_advanced(bpy.types.Panel):
    bl_idname = "HYBRID_MESH_PT_advanced"
    bl_label = "Advanced"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Hybrid Mesh"
    bl_parent_id = "HYBRID_MESH_PT_remesh"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        draw_advanced(self.layout, context.scene.hybrid_mesh)
