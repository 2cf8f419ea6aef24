# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of the levels' meshes: those that Show needs are made when they are first shown."""

import numpy

from ...bridge import meshes, objects, transfer
from ...core.colors import error_colors, patch_colors
from ..levels import made
from ..levels import properties as hierarchy_properties


def level_objects(collection):
    found = (obj for obj in collection.objects if hierarchy_properties.is_level(obj) and obj.hybrid_mesh.hierarchy == collection)
    return [obj for obj in found if obj.type == "MESH" and objects.is_local(obj) and objects.is_local(obj.data)]


def diagonal_of(collection):
    """The length of the diagonal of a hierarchy's finest level in world space; 0 where it is gone."""
    finest = made.finest_level(collection)
    return objects.diagonal(finest) if finest is not None else 0.0


def use_colors(context, collection, name):
    """Has the levels of a hierarchy shown in the colours of that name, which are made where they are missing. Raises ValueError with a line for people."""
    levels = level_objects(collection)
    if name == meshes.ERROR_COLOR:
        _add_errors(context, collection, levels)
    for obj in levels:
        if name == meshes.PATCH_COLOR and name not in obj.data.attributes:
            _add_patches(obj.data)
        index = obj.data.color_attributes.find(name)
        if index >= 0:
            obj.data.color_attributes.active_color_index = index
        obj.data.update_tag()


def _add_patches(mesh):
    patches = meshes.get_attribute(mesh, meshes.PATCH)
    if patches is not None:
        sides = meshes.values_of(mesh.polygons, "loop_total", 1, numpy.int32)
        meshes.set_attribute(mesh, meshes.PATCH_COLOR, "BYTE_COLOR", "CORNER", numpy.repeat(patch_colors(patches), sides, axis=0))


def _add_errors(context, collection, levels):
    """Distances of vertices to the source as they are now: levels may have been edited since."""
    find = _distances_to_source(context, collection)
    diagonal = diagonal_of(collection)
    for obj in levels:
        mesh = obj.data
        points = meshes.in_world(meshes.values_of(mesh.vertices, "co", 3), numpy.array(obj.matrix_world, dtype=numpy.float64))
        colors = error_colors(find(points) / (diagonal or 1.0))
        if meshes.ERROR_COLOR in mesh.attributes:
            mesh.attributes.remove(mesh.attributes[meshes.ERROR_COLOR])
        meshes.set_attribute(mesh, meshes.ERROR_COLOR, "BYTE_COLOR", "POINT", colors)


def _distances_to_source(context, collection):
    source = collection.hybrid_mesh.source
    if source is None or source.type != "MESH" or not objects.in_scene(source, context.scene):
        raise ValueError(f"{collection.name}: what it was made of is not in the scene, so that there is no distance to it")
    with objects.evaluated(context, source) as graph:
        try:
            surface = meshes.read_source(source, graph).mesh
        except ValueError as error:
            raise ValueError(f"{source.name}: {error}") from error
    return transfer.distances(surface)
