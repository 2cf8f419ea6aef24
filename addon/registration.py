# SPDX-License-Identifier: GPL-3.0-or-later
"""What is registered in Blender, in order. A class that cannot be registered stops everything, loudly."""

import bpy

from . import compat, jobs
from .features.layouts import operators as layout_operators
from .features.layouts import panel as layout_panel
from .features.layouts import properties as layout_properties
from .features.layouts import region_operator
from .features.levels import operators as level_operators
from .features.levels import panel as level_panel
from .features.levels import properties as level_properties
from .features.remesh import operators as remesh_operators
from .features.remesh import panel as remesh_panel
from .features.remesh import properties as remesh_properties

CLASSES = (
    level_properties.HybridMeshObject,
    level_properties.HybridMeshCollection,
    layout_properties.HybridMeshProblem,
    layout_properties.HybridMeshLayout,
    layout_properties.HybridMeshRegion,
    remesh_properties.HybridMeshScene,
    remesh_operators.HYBRID_MESH_OT_remesh,
    remesh_operators.HYBRID_MESH_OT_preset,
    level_operators.HYBRID_MESH_OT_show_level,
    layout_operators.HYBRID_MESH_OT_draw_layout,
    layout_operators.HYBRID_MESH_OT_check_layout,
    layout_operators.HYBRID_MESH_OT_show_problem,
    layout_operators.HYBRID_MESH_OT_remesh_layout,
    layout_operators.HYBRID_MESH_OT_remesh_boundary,
    region_operator.HYBRID_MESH_OT_repatch_region,
    layout_panel.HYBRID_MESH_UL_problems,
    remesh_panel.HYBRID_MESH_PT_remesh,
    remesh_panel.HYBRID_MESH_PT_advanced,
    level_panel.HYBRID_MESH_PT_levels,
    layout_panel.HYBRID_MESH_PT_layout,
)
PROPERTY_MODULES = (level_properties, layout_properties, remesh_properties)

_command_line = []


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    for module in PROPERTY_MODULES:
        module.register()
    jobs.register()
    _command_line.append(compat.register_command_line("hybrid_mesh", _run_command_line))


def unregister():
    while _command_line:
        compat.unregister_command_line(_command_line.pop())
    jobs.unregister()
    for module in reversed(PROPERTY_MODULES):
        module.unregister()
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)


def _run_command_line(arguments):
    from .core import cli

    return cli.run(arguments)
