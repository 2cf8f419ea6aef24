# SPDX-License-Identifier: GPL-3.0-or-later
"""How hierarchies are shown: one choice for the scene."""

import bpy
from bpy.props import BoolProperty, EnumProperty

from ...bridge import meshes, view
from ..levels import properties as hierarchy_properties
from . import coloring

MODES = (
    ("SHADED", "Shaded", "The surface alone"),
    ("QUADS", "Quads", "The surface with the edges of its quads"),
    ("PATCHES", "Patches", "A colour for each quad of the base and what has become of it"),
    ("STRETCH", "Stretch", "How much less densely than on average faces sample the surface"),
    ("ERROR", "Error", "How far vertices are from what was remeshed, as both are now"),
)
_COLORS = {"PATCHES": meshes.PATCH_COLOR, "STRETCH": meshes.STRETCH_COLOR, "ERROR": meshes.ERROR_COLOR}


class HybridMeshDisplay(bpy.types.PropertyGroup):
    mode: EnumProperty(
        name="Show", description="What is seen of hybrid meshes", items=MODES, default="QUADS", update=lambda self, context: show_all(context), options=set()
    )
    edges: BoolProperty(
        name="Edges", description="Draw the edges of the quads over colours, too", default=False, update=lambda self, context: show_all(context), options=set()
    )
    legend: BoolProperty(name="Legend", description="Say in the view what the colours mean", default=True, update=lambda self, context: view.redraw(context), options=set())


def draws_edges(scene):
    values = scene.hybrid_mesh_display
    return values.mode != "SHADED" and (values.mode == "QUADS" or values.edges)


def hierarchies_of(scene):
    found = {obj.hybrid_mesh.hierarchy for obj in scene.objects if obj.is_property_set("hybrid_mesh")} - {None}
    return sorted(found, key=lambda collection: collection.name)


def show_all(context):
    """Shows the scene's hierarchies, and has the 3D views of the window show them, as the scene says."""
    with view.waiting(context):
        lines = list(filter(None, (show(context, collection) for collection in hierarchies_of(context.scene))))
    view.shade(context, "VERTEX" if context.scene.hybrid_mesh_display.mode in _COLORS else "MATERIAL")
    if lines and not bpy.app.background:
        context.window_manager.popup_menu(lambda menu, _: [menu.layout.label(text=line) for line in lines], title="Show", icon="ERROR")


def show(context, collection):
    """Shows a hierarchy as the scene says; returns a line for people where that cannot be."""
    edges, mode, line = draws_edges(context.scene), context.scene.hybrid_mesh_display.mode, ""
    preview = collection.hybrid_mesh.preview
    for obj in (*coloring.level_objects(collection), *([preview] if preview is not None else [])):
        obj.show_wire = obj.show_all_edges = edges
    if mode in _COLORS:
        try:
            coloring.use_colors(context, collection, _COLORS[mode])
        except ValueError as error:
            line = str(error)
    if preview is not None:
        preview.update_tag()
    return line


def shown_hierarchy(context):
    """The hierarchy that the active object is part of or the source of, if there is one in the scene."""
    obj = context.view_layer.objects.active
    return hierarchy_properties.hierarchy_of(obj) if obj is not None else None


PROPERTIES = ((bpy.types.Scene, "hybrid_mesh_display", HybridMeshDisplay),)
