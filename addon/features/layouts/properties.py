# SPDX-License-Identifier: GPL-3.0-or-later
"""What a drawn layout, and the objects that show what became of it, know about themselves, saved in the .blend."""

import bpy
from bpy.props import CollectionProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty, StringProperty

from ...bridge import objects, strokes
from ...core.limits import limits
from ..levels.properties import hierarchy_of, is_level

KINDS = (
    ("NONE", "None", "Nothing to do with layouts"),
    ("DRAWN", "Drawn", "The strokes of a layout"),
    ("CURVES", "Curves", "What a check made of the strokes: curves and nodes on the surface"),
    ("PROBLEMS", "Problems", "Marks where a check found something wrong"),
)
REGION_LAYOUTS = (
    ("DRAWN", "Drawn Curves", "The new quads are those that are drawn; where nothing is drawn, as with Automatic"),
    ("AUTOMATIC", "Automatic", "The new quads are found from the region's boundary, so that its corners become regular; rows in a ring, even quads where there are more boundaries or handles"),
    ("CUBES", "Cubes", "A tower of cubes grows skin on the region: rings of quads along its boundary, and its own quads on top"),
    ("ROWS", "Rows", "Rows of quads for a region that is a ring, from one of its boundaries to the other"),
    ("EVEN", "Even", "Quads of even size, whatever the region's topology: it may have handles and several boundaries"),
    ("COPY", "Copy", "The new quads are arranged as another operation of the hierarchy has them; the region has as many sides as that one's"),
)


class RegionProperties:
    """Mix-in for whatever has the settings of a region that is laid out anew as properties."""

    layout_kind: EnumProperty(name="Layout", description="Where the region's new quads come from", items=REGION_LAYOUTS, default="DRAWN")
    height: IntProperty(
        name="Height", description="Cubes of the tower, or rows of the ring; 0 for as many as make the quads square", default=0, min=0,
        max=limits().most_cubes, soft_max=20,
    )  # fmt: skip
    even_quads: IntProperty(
        name="Quads", description="About how many even quads the region gets; 0 for as many as it has", default=0, min=0, max=limits().most_even_quads
    )
    turn: IntProperty(name="Turn", description="Turns the copied layout by so many corners of the region's boundary", default=0, min=-100, max=100)
    buffer_rings: IntProperty(
        name="Buffer Rings", description="Rings of quads around the region that are smoothed with it", default=1, min=0,
        max=limits().most_buffer_rings, soft_max=8,
    )  # fmt: skip


REGION_NAMES = tuple(RegionProperties.__annotations__)


def draw_region(layout, properties):
    layout.use_property_split = True
    layout.use_property_decorate = False
    column = layout.column()
    column.prop(properties, "layout_kind")
    if properties.layout_kind == "EVEN":
        column.prop(properties, "even_quads")
    if properties.layout_kind in ("CUBES", "ROWS"):
        column.prop(properties, "height")
    if properties.layout_kind == "COPY":
        column.prop(properties, "turn")
    column.prop(properties, "buffer_rings")


class HybridMeshRegion(RegionProperties, bpy.types.PropertyGroup):
    pass


class HybridMeshProblem(bpy.types.PropertyGroup):
    kind: StringProperty(name="Kind")
    message: StringProperty(name="Problem", description="What is wrong")
    place: FloatVectorProperty(name="Place", description="Where, in the space of the layout's object")
    size: FloatProperty(name="Size", description="How far what is wrong reaches; negative where it has no place", default=-1)
    layer: StringProperty(name="Layer", description="Layer of the stroke that is wrong, if it is one")
    number: IntProperty(name="Stroke", description="Number of that stroke in its layer", default=-1)


class HybridMeshLayout(bpy.types.PropertyGroup):
    kind: EnumProperty(name="Kind", items=KINDS, default="NONE")
    surface: PointerProperty(name="Surface", type=bpy.types.Object, description="The mesh object that is drawn on")
    snap: FloatProperty(
        name="Snap", description="What ends so near to a node, a curve or the boundary is joined with it; a fraction of the bounding-box diagonal",
        default=0.02, min=0, max=limits().most_snap, soft_max=0.2, precision=3, step=0.1,
    )  # fmt: skip
    problems: CollectionProperty(type=HybridMeshProblem)
    problem_index: IntProperty(name="Problem", min=0)
    summary: StringProperty(name="Summary", description="What the last check found")


def surface_of(obj, scene):
    """The mesh object that an object stands for where layouts are drawn: itself, or what it is a layout, a mark or the preview of; or None."""
    if obj is None:
        return None
    if _kind(obj) != "NONE":
        surface = obj.hybrid_mesh_layout.surface
    elif obj.type == "MESH" and obj.is_property_set("hybrid_mesh") and obj.hybrid_mesh.role == "PREVIEW":
        hierarchy = hierarchy_of(obj)
        surface = hierarchy.hybrid_mesh.source if hierarchy is not None else None
    else:
        surface = obj
    return surface if surface is not None and surface.type == "MESH" and objects.in_scene(surface, scene) else None


def layout_of(surface, scene, kind="DRAWN"):
    """The object of a kind that belongs to a mesh object, or None."""
    found = (obj for obj in scene.objects if strokes.is_grease_pencil(obj) and _kind(obj) == kind and obj.hybrid_mesh_layout.surface == surface)
    return min(found, key=lambda obj: obj.name, default=None)


def drawn_on(surface, context):
    """The layout that is drawn in on a mesh object: the active object, or the first one that there is, or None."""
    active = objects.active(context)
    if active is not None and _kind(active) == "DRAWN" and active.hybrid_mesh_layout.surface == surface:
        return active
    return layout_of(surface, context.scene)


def _kind(obj):
    # Asked first, because reading a property group that was never set leaves an empty one behind.
    return obj.hybrid_mesh_layout.kind if obj.is_property_set("hybrid_mesh_layout") else "NONE"


PROPERTIES = ((bpy.types.Object, "hybrid_mesh_layout", HybridMeshLayout), (bpy.types.Scene, "hybrid_mesh_region", HybridMeshRegion))
