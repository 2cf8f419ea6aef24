# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes of a rigged object: its surface as it is, at rest, and with one shape key; and vertices that go where it goes."""

import contextlib

import bpy
import numpy

from . import meshes, objects, transfer


class ShapeError(ValueError):
    """An object whose shapes cannot be compared; the message says why."""


@contextlib.contextmanager
def still(context, source):
    """Gives a Still of a mesh object, and takes away what it needs."""
    one = Still(context, source)
    try:
        yield one
    finally:
        one.clear()


class Still:
    """A copy of a mesh object that no armature moves, in which one shape key at a time is shown."""

    def __init__(self, context, source):
        self._context, self._name = context, source.name
        self._copy = source.copy()
        self._copy.data = source.data.copy()
        self._copy.animation_data_clear()
        self._copy.parent = None
        self._copy.constraints.clear()
        for modifier in [one for one in self._copy.modifiers if one.type == "ARMATURE"]:
            self._copy.modifiers.remove(modifier)
        keys = self._copy.data.shape_keys
        if keys is not None:
            keys.animation_data_clear()
            for key in keys.key_blocks:
                key.vertex_group, key.mute = "", False
            self._copy.show_only_shape_key = True
        self._copy.hide_viewport = False
        context.scene.collection.objects.link(self._copy)

    def clear(self):
        mesh = self._copy.data
        bpy.data.objects.remove(self._copy)
        bpy.data.meshes.remove(mesh)

    def read(self, key=0, read=None):
        """The points (n, 3) of the evaluated mesh, in the object's space, with the shape key of that number alone, 0 being the basis; or what read(object, mesh) says."""
        self._copy.active_shape_key_index = key
        self._copy.update_tag(refresh={"OBJECT", "DATA"})
        self._context.view_layer.update()
        return _evaluated(self._copy, self._context.evaluated_depsgraph_get(), read)


def as_it_is(context, source):
    """The points of the evaluated mesh of an object, all that moves it being applied, in its own space."""
    with objects.evaluated(context, source) as graph:
        return _evaluated(source, graph, None)


def _evaluated(obj, graph, read):
    evaluated = obj.evaluated_get(graph)
    mesh = evaluated.to_mesh()
    try:
        if mesh is None or not mesh.polygons:
            raise ShapeError(f"{obj.name} has no faces")
        return read(obj, mesh) if read else meshes.values_of(mesh.vertices, "co", 3).astype(numpy.float64)
    finally:
        evaluated.to_mesh_clear()


def set_key(key, places):
    """Puts the vertices of a shape key elsewhere."""
    key.data.foreach_set("co", numpy.ascontiguousarray(places, dtype=numpy.float32).ravel())


def triangles_of(obj, mesh):
    """(points, (n, 3) corners of triangles) of an evaluated mesh: what read() takes."""
    mesh.calc_loop_triangles()
    return meshes.values_of(mesh.vertices, "co", 3).astype(numpy.float64), meshes.values_of(mesh.loop_triangles, "vertices", 3, numpy.int32)


class Ride:
    """Vertices that go with a surface: over three of its vertices each, and a little beside them, which turns as these do."""

    def __init__(self, corners, weights, shape, vertices):
        """shape: the surface's points when the vertices were where they are."""
        self._corners, self._weights, self._shape, self._vertices = corners, weights, shape, vertices
        self._beside = vertices - self._on(shape)
        self._frames = _frames(shape[corners])

    def off(self):
        """How far the vertices are from the surface, on average."""
        return float(numpy.linalg.norm(self._beside, axis=1).mean()) if len(self._beside) else 0.0

    def __call__(self, shape):
        """Where the vertices are when the surface has another shape."""
        if numpy.array_equal(shape, self._shape):
            return self._vertices.copy()
        local = numpy.einsum("vij,vi->vj", self._frames, self._beside)
        return self._on(shape) + numpy.einsum("vij,vj->vi", _frames(shape[self._corners]), local)

    def carried(self, values):
        """Values of the surface's vertices as these have them."""
        return numpy.einsum("vk,vk->v", self._weights, values[self._corners])

    def _on(self, shape):
        return numpy.einsum("vk,vki->vi", self._weights, shape[self._corners])


def _frames(triangles):
    """Orthonormal frames of triangles, as columns; of one without area some frame."""
    along, across = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    first = _unit(along, (1.0, 0.0, 0.0))
    normal = numpy.cross(along, across)
    least = numpy.abs(first).argmin(axis=1)
    some = numpy.cross(first, numpy.eye(3)[least])
    third = _unit(numpy.where(numpy.linalg.norm(normal, axis=1, keepdims=True) > 0, normal, some), (0.0, 0.0, 1.0))
    return numpy.stack([first, numpy.cross(third, first), third], axis=2)


def _unit(vectors, otherwise):
    lengths = numpy.linalg.norm(vectors, axis=1, keepdims=True)
    return numpy.where(lengths > 0, vectors / numpy.where(lengths > 0, lengths, 1), otherwise)


def nearest_places(points, triangles, vertices):
    """(corners, weights) of the nearest places of a surface, for vertices whose places are not kept."""
    arrays = meshes.MeshArrays(points, numpy.arange(0, 3 * len(triangles) + 1, 3), triangles.ravel())
    corners = triangles[transfer.nearest_triangles(arrays)(vertices)]
    return corners, transfer.closest_weights(vertices, points[corners])
