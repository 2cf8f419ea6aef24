# SPDX-License-Identifier: GPL-3.0-or-later
"""The loops of a mesh object around its handles and tunnels, saved in the .blend, and what a remesh makes of them."""

import bpy
import numpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ...bridge import arrays, objects
from ...core import loops as lines
from ...core import plans
from ...core.limits import limits
from ..layouts import properties as layout_properties
from . import display

KINDS = (
    ("HANDLE", "Handle", "Around a handle: cut along it, the surface is capped within"),
    ("TUNNEL", "Tunnel", "Around a tunnel: cut along it, the surface is capped across the hole"),
)


def _changed(values, context):
    display.refresh(values.id_data)


class HybridMeshLoop(bpy.types.PropertyGroup):
    kind: EnumProperty(name="Kind", items=KINDS)
    length: FloatProperty(name="Length", description="As a fraction of the bounding-box diagonal")
    points: StringProperty(name="Points", description="In the space of the object, as JSON")
    level: IntProperty(
        name="Level", description="It opens on this level, or, where that has no room for it, on the next one that has; -1 for the first one with room for it, 0 for the base", default=-1, min=-1,
        max=limits().most_levels, update=_changed,
    )  # fmt: skip
    use: BoolProperty(name="Late", description="It is closed on the base and opens on a finer level; else it is open in the base", default=True, update=_changed)
    drawn: BoolProperty(name="Drawn", description="Drawn by hand")


class HybridMeshTopology(bpy.types.PropertyGroup):
    loops: CollectionProperty(type=HybridMeshLoop)
    index: IntProperty(name="Loop", min=0, update=_changed)
    surface: PointerProperty(name="Surface", type=bpy.types.Object, description="The mesh object whose loops are shown")


def surface_of(obj, scene):
    """The mesh object that an object stands for where loops are concerned: itself, or what it shows the loops, a layout or the preview of; or None."""
    if obj is not None and obj.type == "CURVE" and obj.is_property_set("hybrid_mesh_topology"):
        obj = obj.hybrid_mesh_topology.surface
    surface = layout_properties.surface_of(obj, scene)
    return None if layout_properties.is_level(surface) else surface


def loops_of(surface):
    """The loops of a mesh object; empty where none were ever looked for."""
    # Asked first, because reading a property group that was never set leaves an empty one behind.
    return surface.hybrid_mesh_topology.loops if surface.is_property_set("hybrid_mesh_topology") else ()


def world_lines(loops, source):
    """The points of each loop in world space, exactly where the meshes.Source has its own; raises LoopError."""
    found = [arrays.transformed(lines.from_text(loop.points), source.matrix) for loop in loops]
    if not found:
        return []
    # All at once: the surface's points are put in order but once.
    return numpy.split(lines.moved_to(source.mesh.points, numpy.concatenate(found)), numpy.cumsum([len(points) for points in found])[:-1])


def plan_of(surface, source):
    """The plan's text that the loops of a mesh object ask for, which was read as a meshes.Source; empty where it has none. Raises LoopError."""
    found = loops_of(surface)
    if not len(found):
        return ""
    late = [loop for loop in found if loop.use and loop.level != 0]
    return plans.topology_plan([(points, loop.level) for loop, points in zip(late, world_lines(late, source), strict=True)])


def write(surface, source, found, settings):
    """Puts loops in place of those of a mesh object. found: as the native find_loops() gives them; settings: (level, use) of each of the loops that there were."""
    values = surface.hybrid_mesh_topology
    values.loops.clear()
    inverse = numpy.linalg.inv(source.matrix)
    used = source.mesh.points[source.mesh.indices]
    diagonal = float(numpy.linalg.norm(numpy.ptp(used, axis=0)))
    for one in found:
        loop = values.loops.add()
        loop.kind = one["kind"].upper()
        loop.length = one["length"] / diagonal
        loop.points = lines.to_text(arrays.transformed(one["positions"], inverse))
        loop.drawn = one["drawn"]
        if one["source"] >= 0:
            _set(loop, "level", settings[one["source"]][0])
            _set(loop, "use", settings[one["source"]][1])
    _set(values, "index", min(values.index, max(len(found) - 1, 0)))


def _set(values, name, value):
    # What changes nothing is not to be drawn anew.
    if getattr(values, name) != value:
        setattr(values, name, value)


def say_later(operator, surface, source, plan):
    """Says which loops of a mesh object a remesh has opened on later levels than they were given. source: what it has read of it; plan: the text of what it has decided."""
    asked = [(number, loop) for number, loop in enumerate(loops_of(surface), 1) if loop.use and loop.level > 0]
    opened = plans.opening_levels(plan) if asked else {}
    for (number, loop), points in zip(asked, world_lines([loop for _, loop in asked], source), strict=True):
        level = opened.get(plans.line_key(points), loop.level)
        if level > loop.level:
            operator.report({"WARNING"}, f"{surface.name}: loop {number} opens on level {level}: there was no room for it on level {loop.level}, which it was given")


def say_unused(operator, surface):
    """Says that a remesh whose base was given has no use for the loops of a mesh object."""
    if surface is not None and len(loops_of(surface)):
        operator.report({"WARNING"}, f"{surface.name}: the base was given, so its loops are not used")


def refuse_foreign(surface):
    """Raises ValueError where the loops of a mesh object cannot be changed."""
    if not objects.is_local(surface):
        raise ValueError(f"{surface.name} comes from a library, which keeps its loops; make it local")


PROPERTIES = ((bpy.types.Object, "hybrid_mesh_topology", HybridMeshTopology),)
