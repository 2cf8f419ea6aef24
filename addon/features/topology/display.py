# SPDX-License-Identifier: GPL-3.0-or-later
"""The curve object that shows the loops of a mesh object: coloured by level, the active one thick."""

import bpy
import numpy

from ...bridge import arrays, curves, objects, placement
from ...bridge.names import with_suffix
from ...core import loops as lines
from ...core.colors import level_color

_PAINT = "hybrid_mesh_loop_level"  # on a material: the level whose loops it colours
_AUTOMATIC, _BASE = -1, 0
_RADIUS = 0.0015  # of the surface's bounding-box diagonal
_THICK = 2.5


def show(context, surface):
    """Shows the loops of a mesh object in an object of their own; without any it goes."""
    shown = shown_loops(surface)
    if not len(surface.hybrid_mesh_topology.loops):
        if shown is not None:
            curve = shown.data
            bpy.data.objects.remove(shown)
            if not curve.users:
                bpy.data.curves.remove(curve)
        return
    if shown is None:
        shown = curves.new_object(with_suffix(surface.name, ".loops"), placement.collection_beside(context, surface))
        shown.hybrid_mesh_topology.surface = surface
        shown.hide_render = shown.hide_select = shown.show_in_front = True
        placement.go_with(context, shown, surface)
    placement.show(context, shown, surface)
    _fill(shown, surface)


def refresh(surface):
    """Shows what has changed of the loops, where they are shown at all."""
    shown = shown_loops(surface)
    if shown is not None and objects.is_local(shown) and objects.is_local(shown.data):
        _fill(shown, surface)


def shown_loops(surface):
    """The object that shows the loops of a mesh object, or None."""
    # Asked first, because reading a property group that was never set leaves an empty one behind.
    curved = (obj for obj in bpy.data.objects if obj.type == "CURVE" and obj.is_property_set("hybrid_mesh_topology"))
    found = [obj for obj in curved if obj.hybrid_mesh_topology.surface == surface]
    return min(found, key=lambda obj: (obj.parent != surface, obj.name), default=None)


def _fill(shown, surface):
    values = surface.hybrid_mesh_topology
    matrix = numpy.array(surface.matrix_world, dtype=float)
    chosen = []
    for number, loop in enumerate(values.loops):
        try:
            points = arrays.transformed(lines.from_text(loop.points), matrix)
        except lines.LoopError:
            continue  # A remesh says so.
        chosen.append((points, _THICK if number == values.index else 1, _paint(loop.level if loop.use else _BASE)))
    try:
        curves.write_closed(shown, chosen, _RADIUS * objects.diagonal(surface))
    except arrays.MatrixError:
        pass  # Flattened, it is not seen anyway.


def _paint(level):
    for material in bpy.data.materials:
        if material.get(_PAINT) == level and material.library is None:
            return material
    name = {_AUTOMATIC: "Loops", _BASE: "Loops in the Base"}.get(level, f"Loops of Level {level}")
    material = bpy.data.materials.new(name)
    material.diffuse_color = level_color(level)  # in Solid shading
    material[_PAINT] = level
    return material
