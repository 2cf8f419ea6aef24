# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from ..wrapping import draw_wrapped
from . import properties


class HYBRID_MESH_UL_problems(bpy.types.UIList):
    bl_idname = "HYBRID_MESH_UL_problems"

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index):
        row = layout.row(align=True)
        row.label(text=item.message, icon="ERROR")
        row.operator("hybrid_mesh.show_problem", text="", icon="VIEWZOOM", emboss=False).index = index


class HYBRID_MESH_PT_layout(bpy.types.Panel):
    bl_idname = "HYBRID_MESH_PT_layout"
    bl_label = "Patch Layout"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Hybrid Mesh"
    bl_order = 2

    @classmethod
    def poll(cls, context):
        return properties.surface_of(context.object, context.scene) is not None

    def draw(self, context):
        layout = self.layout
        surface = properties.surface_of(context.object, context.scene)
        drawn = properties.drawn_on(surface, context)
        layout.label(text=surface.name, icon="MESH_DATA")
        layout.operator("hybrid_mesh.draw_layout", icon="GREASEPENCIL")
        if properties.is_level(surface):
            self._region(layout, context.scene.hybrid_mesh_region)
        elif drawn is not None:
            self._whole(layout, drawn.hybrid_mesh_layout)
        if drawn is not None:
            self._problems(context, layout, drawn.hybrid_mesh_layout)
        if not properties.is_level(surface):
            self._boundary(layout, context.scene.hybrid_mesh)

    def _problems(self, context, layout, values):
        if len(values.problems):
            layout.template_list("HYBRID_MESH_UL_problems", "", values, "problems", values, "problem_index", rows=min(len(values.problems), 6))
            if values.problem_index < len(values.problems):
                self._words(context, layout, values.problems[values.problem_index])

    def _whole(self, layout, values):
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.prop(values, "snap")
        layout.operator("hybrid_mesh.check_layout", icon="VIEWZOOM")
        if values.summary:
            layout.label(text=values.summary, icon="INFO" if len(values.problems) else "CHECKMARK")
        column = layout.column()
        column.scale_y = 1.4
        column.operator("hybrid_mesh.remesh_layout", icon="MOD_REMESH")

    def _boundary(self, layout, settings):
        layout.separator()
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.prop(settings, "cubes")
        column.operator("hybrid_mesh.remesh_boundary", icon="MOD_REMESH").cubes = settings.cubes

    def _words(self, context, layout, problem):
        """All that is said of a problem."""
        text = problem.message if problem.number < 0 else f"{problem.message} (stroke {problem.number + 1} of {problem.layer})"
        draw_wrapped(context, layout, text)

    def _region(self, layout, values):
        properties.draw_region(layout.column(), values)
        column = layout.column()
        column.scale_y = 1.4
        if values.layout_kind == "COPY":
            operator = column.operator_menu_enum("hybrid_mesh.repatch_region", "source", icon="MOD_REMESH")
        else:
            operator = column.operator("hybrid_mesh.repatch_region", icon="MOD_REMESH")
        for name in properties.REGION_NAMES:
            setattr(operator, name, getattr(values, name))
