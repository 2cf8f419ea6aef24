# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts objects where another object stands, or where a matrix says."""

import mathutils
import numpy

from . import objects
from .arrays import world_matrix


def same_place(source):
    """A function that gives an object the transform and parent of `source`."""

    def place(obj):
        obj.rotation_mode = source.rotation_mode
        if source.parent is not None:
            obj.parent = source.parent
            # What an armature moves by being the parent has been moved already, when it was measured.
            obj.parent_type = "OBJECT" if source.parent_type == "ARMATURE" else source.parent_type
            if source.parent_type == "BONE":
                obj.parent_bone = source.parent_bone
            elif source.parent_type in {"VERTEX", "VERTEX_3"}:
                obj.parent_vertices = source.parent_vertices
            obj.matrix_parent_inverse = source.matrix_parent_inverse
        for name in ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale"):
            setattr(obj, name, getattr(source, name))
        for name in ("delta_location", "delta_rotation_euler", "delta_rotation_quaternion", "delta_scale"):
            setattr(obj, name, getattr(source, name))
        if source.constraints or _animated(source):
            # Where something else moves the source, the place where it stands now is what was measured.
            obj.matrix_world = source.matrix_world

    return place


def by_matrix(matrix, placement):
    """How objects are put where a file has them: (the matrix that their meshes are to be made with, a function that puts an object there).

    matrix: from the space of the objects to that of the points; placement: to the world; each 16 numbers, row by row. What no object can have
    (shear) goes into the mesh. Raises MatrixError.
    """
    with numpy.errstate(over="ignore", invalid="ignore"):
        matrix, placement = (world_matrix(numpy.reshape(values, (4, 4))) for values in (matrix, placement))
    stands = mathutils.Matrix.LocRotScale(*mathutils.Matrix(placement).decompose())
    possible = numpy.array(stands, dtype=numpy.float64)
    if numpy.abs(possible - placement)[:3, :3].max() > 1e-5 * numpy.abs(placement[:3, :3]).max():
        matrix = matrix @ numpy.linalg.inv(placement) @ possible

    def place(obj):
        obj.matrix_basis = stands

    return matrix, place


def _animated(obj):
    data = obj.animation_data
    return data is not None and bool(data.drivers)


def go_with(context, obj, surface):
    """Puts an object where a surface stands. It goes where the surface goes, but is neither turned nor scaled: lines keep their thickness."""
    obj.parent = surface
    obj.matrix_parent_inverse = surface.matrix_world.inverted()
    obj.location = surface.matrix_world.translation
    context.view_layer.update()


def show(context, obj, surface):
    """Makes an object that belongs to a surface visible, whatever has been hidden."""
    if not objects.in_view_layer(obj, context.view_layer):
        collection_beside(context, surface).objects.link(obj)
    obj.hide_viewport = False
    obj.hide_set(False)
    if not obj.visible_get() and obj not in context.scene.collection.objects.values():
        context.scene.collection.objects.link(obj)  # All collections that it is in are hidden.
    context.view_layer.update()


def collection_beside(context, surface):
    """Where new objects go: beside the surface, if that is in view and in a collection that takes them."""
    seen = [layer.collection for layer in _visible(context.view_layer.layer_collection)]
    beside = [collection for collection in surface.users_collection if collection in seen and objects.is_local(collection)]
    return beside[0] if beside else context.scene.collection


def _visible(layer_collection):
    if layer_collection.exclude or not layer_collection.is_visible:
        return
    yield layer_collection
    for child in layer_collection.children:
        yield from _visible(child)
