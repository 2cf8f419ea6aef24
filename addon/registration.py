# SPDX-License-Identifier: GPL-3.0-or-later
"""What is registered in Blender, in order. What cannot be registered stops everything, loudly, and nothing is left registered."""

import contextlib

import bpy

from . import compat, jobs
from .features.baking import operators as baking_operators
from .features.display import legend as display_legend
from .features.display import operators as display_operators
from .features.display import properties as display_properties
from .features.files import operators as file_operators
from .features.layouts import operators as layout_operators
from .features.layouts import panel as layout_panel
from .features.layouts import properties as layout_properties
from .features.layouts import region_operator
from .features.levels import mesh_operator
from .features.levels import operators as level_operators
from .features.levels import panel as level_panel
from .features.levels import properties as level_properties
from .features.levels import stored as stored_levels
from .features.levels import streams as level_streams
from .features.multires import operators as multires_operators
from .features.remesh import operators as remesh_operators
from .features.remesh import panel as remesh_panel
from .features.remesh import properties as remesh_properties
from .features.retarget import operators as retarget_operators
from .features.topology import operators as topology_operators
from .features.topology import panel as topology_panel
from .features.topology import properties as topology_properties

CLASSES = (
    level_properties.HybridMeshObject,
    level_properties.HybridMeshCollection,
    level_streams.HybridMeshStream,
    layout_properties.HybridMeshProblem,
    layout_properties.HybridMeshLayout,
    layout_properties.HybridMeshRegion,
    topology_properties.HybridMeshLoop,
    topology_properties.HybridMeshTopology,
    remesh_properties.HybridMeshScene,
    display_properties.HybridMeshDisplay,
    display_operators.HYBRID_MESH_OT_toggle_quads,
    display_operators.HYBRID_MESH_OT_step_level,
    remesh_operators.HYBRID_MESH_OT_remesh,
    remesh_operators.HYBRID_MESH_OT_preset,
    level_operators.HYBRID_MESH_OT_show_level,
    level_operators.HYBRID_MESH_OT_show_reason,
    level_operators.HYBRID_MESH_OT_update_levels,
    level_operators.HYBRID_MESH_OT_reset_level,
    mesh_operator.HYBRID_MESH_OT_make_mesh,
    multires_operators.HYBRID_MESH_OT_convert_to_multires,
    baking_operators.HYBRID_MESH_OT_bake,
    retarget_operators.HYBRID_MESH_OT_retarget,
    file_operators.HYBRID_MESH_OT_import_hmesh,
    file_operators.HYBRID_MESH_OT_export_hmesh,
    layout_operators.HYBRID_MESH_OT_draw_layout,
    layout_operators.HYBRID_MESH_OT_check_layout,
    layout_operators.HYBRID_MESH_OT_show_problem,
    layout_operators.HYBRID_MESH_OT_remesh_layout,
    layout_operators.HYBRID_MESH_OT_remesh_boundary,
    region_operator.HYBRID_MESH_OT_repatch_region,
    topology_operators.HYBRID_MESH_OT_find_loops,
    topology_operators.HYBRID_MESH_OT_draw_loop,
    topology_operators.HYBRID_MESH_OT_remove_loop,
    topology_operators.HYBRID_MESH_OT_clear_loops,
    layout_panel.HYBRID_MESH_UL_problems,
    topology_panel.HYBRID_MESH_UL_loops,
    remesh_panel.HYBRID_MESH_PT_remesh,
    remesh_panel.HYBRID_MESH_PT_advanced,
    level_panel.HYBRID_MESH_PT_levels,
    level_panel.HYBRID_MESH_PT_figures,
    layout_panel.HYBRID_MESH_PT_layout,
    topology_panel.HYBRID_MESH_PT_topology,
)
# Whose property groups what of Blender's has: type, attribute, group.
PROPERTIES = (
    *level_properties.PROPERTIES,
    *level_streams.PROPERTIES,
    *layout_properties.PROPERTIES,
    *topology_properties.PROPERTIES,
    *remesh_properties.PROPERTIES,
    *display_properties.PROPERTIES,
)

_registered = contextlib.ExitStack()  # how to undo it all, the last first


def register():
    with contextlib.ExitStack() as undo:
        for cls in CLASSES:
            bpy.utils.register_class(cls)
            undo.callback(bpy.utils.unregister_class, cls)
        for owner, name, group in PROPERTIES:
            setattr(owner, name, bpy.props.PointerProperty(type=group))
            undo.callback(delattr, owner, name)
        for menu, entry in file_operators.MENUS:
            menu.append(entry)
            undo.callback(menu.remove, entry)
        for part in (jobs, stored_levels, display_operators, display_legend):
            part.register()
            undo.callback(part.unregister)
        undo.callback(compat.unregister_command_line, compat.register_command_line("hybrid_mesh", _run_command_line))
        _registered.enter_context(undo.pop_all())


def unregister():
    _registered.close()


def _run_command_line(arguments):
    from .core import cli

    return cli.run(arguments)
