# SPDX-License-Identifier: GPL-3.0-or-later
"""Multires modifiers whose finest level has given places."""

import bpy
import numpy

from . import grids, meshes

MODIFIER = "Multires"


def add_multires(context, obj, level_grids, places, steps):
    """Gives a mesh object of quads a Multires modifier of so many levels, the finest of which has its vertices where they are to be.

    level_grids: grids.level_grids() over the faces of the mesh, by their order and corners; places: of the vertices that these name, in the object's space. The object is
    in the view layer. Returns how far the farthest vertex is from its place. Raises meshes.MeshError.
    """
    modifier = obj.modifiers.new(MODIFIER, "MULTIRES")
    with _active(context, obj):
        for _ in range(steps):
            _must(bpy.ops.object.multires_subdivide(modifier=modifier.name, mode="CATMULL_CLARK"))
    modifier.levels = modifier.sculpt_levels = modifier.render_levels = steps
    order = _order(context, obj, level_grids, len(places), steps)
    wanted = numpy.ascontiguousarray(places[order], dtype=numpy.float32)
    target = bpy.data.objects.new("reshape", bpy.data.meshes.new("reshape"))
    try:
        target.data.vertices.add(len(wanted))
        target.data.vertices.foreach_set("co", wanted.ravel())
        context.scene.collection.objects.link(target)
        context.view_layer.update()
        with _active(context, obj, target):
            _must(bpy.ops.object.multires_reshape(modifier=modifier.name))
    finally:
        mesh = target.data
        bpy.data.objects.remove(target)
        bpy.data.meshes.remove(mesh)
    made = _evaluated(context, obj, lambda mesh: meshes.values_of(mesh.vertices, "co", 3))
    return float(numpy.abs(made - wanted).max(initial=0))


def _order(context, obj, level_grids, count, steps):
    """For each vertex of the subdivided mesh the vertex of the level. How Blender numbers what it subdivides is known, and checked on its own faces."""
    mesh = obj.data
    corners = meshes.values_of(mesh.loops, "vertex_index", 1, numpy.int32).reshape(-1, 4)
    sides = meshes.values_of(mesh.loops, "edge_index", 1, numpy.int32).reshape(-1, 4)
    ends = meshes.values_of(mesh.edges, "vertices", 2, numpy.int32)
    own = grids.subdivided_grids(corners, sides, ends, len(mesh.vertices), steps)
    vertices, faces = _evaluated(context, obj, lambda made: (len(made.vertices), meshes.values_of(made.loops, "vertex_index", 1, numpy.int32).reshape(-1, 4)))
    if vertices != count or not grids.same_faces(grids.grid_faces(own), faces):
        raise meshes.MeshError(f"Blender's subdivision of {obj.name} is not the level's")
    try:
        return grids.correspondence(own, level_grids, vertices)
    except grids.GridError as error:
        raise meshes.MeshError(f"{obj.name}: {error}") from error


def _evaluated(context, obj, read):
    """What read(mesh) says of an object's mesh with its modifiers applied."""
    evaluated = obj.evaluated_get(context.evaluated_depsgraph_get())
    try:
        return read(evaluated.to_mesh())
    finally:
        evaluated.to_mesh_clear()


def _active(context, obj, *selected):
    chosen = [*selected, obj]
    return context.temp_override(object=obj, active_object=obj, selected_objects=chosen, selected_editable_objects=chosen)


def _must(result):
    if result != {"FINISHED"}:
        raise meshes.MeshError("Blender has refused to make the Multires levels")
