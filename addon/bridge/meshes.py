# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh objects as arrays in world space, and arrays as meshes in object space."""

from dataclasses import dataclass
from typing import Any

import bmesh
import bpy
import mathutils
import numpy

from .. import compat
from .arrays import MeshArrays, mirrors, reversed_corners, reversed_edges, transformed, world_matrix
from .objects import key_of

STRETCH, STRETCH_COLOR, ANISOTROPY, PATCH, IRREGULAR, PATCH_UV = "stretch", "stretch_color", "anisotropy", "patch", "irregular", "patches"
PATCH_COLOR, ERROR_COLOR = "patch_color", "error_color"  # made when they are to be shown
OPENED, OPENED_LEVEL = "opened", "opened_level"  # the event of the topology that opened where a face was put in, 1 for the plan's first; 0 for none
ROOT, PATH = "root", "path"  # the address of a face's quad: its root quad's number, and 1 followed by the children in base 4


class SourceError(ValueError):
    """A mesh object that cannot be remeshed; the message says why."""


class MeshError(RuntimeError):
    """Arrays that are no mesh that Blender can hold."""


@dataclass
class Source:
    """What was read of an object: its evaluated surface as triangles in world space, and how to put a result back."""

    key: tuple  # objects.key_of() the object
    mesh: MeshArrays
    matrix: numpy.ndarray  # object to world
    triangle_polygons: numpy.ndarray  # the polygon of each triangle
    triangle_loops: numpy.ndarray  # (n, 3) the corners of each triangle, in its order in `mesh`
    carried: Any  # transfer.Carried: what the surface carries
    density: Any = None  # (points,) what is to make quads smaller or larger, if that is wanted


def read_source(obj, depsgraph, collect=None, density=None):
    """The evaluated mesh of a mesh object (modifiers applied) in world space, faces counter-clockwise seen from outside there.

    N-gons are cut as Blender shows them, so that source triangle t of a result is triangle t of the Source.
    collect(obj, mesh) reads what the surface carries, and density(obj, mesh) a value a vertex by which quads are made smaller or larger, if that is wanted.
    Raises SourceError or MatrixError.
    """
    matrix = world_matrix(obj.matrix_world)
    evaluated = obj.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    if mesh is None:
        raise SourceError("it has no mesh")
    try:
        return _source_of(obj, mesh, matrix, collect, density)
    finally:
        evaluated.to_mesh_clear()


def read_mesh(obj, matrix, collect=None):
    """The same of an object's mesh as it stands, without modifiers, and as if the object had that matrix."""
    return _source_of(obj, obj.data, matrix, collect, None)


def _source_of(obj, mesh, matrix, collect, density):
    if not mesh.polygons:
        raise SourceError("it has no faces")
    points = values_of(mesh.vertices, "co", 3).astype(numpy.float64)
    corners = values_of(mesh.loops, "vertex_index", 1, numpy.int32)
    mesh.calc_loop_triangles()
    loops = values_of(mesh.loop_triangles, "loops", 3, numpy.int32)
    polygons = values_of(mesh.loop_triangles, "polygon_index", 1, numpy.int32)
    carried = collect(obj, mesh) if collect else None
    densities = density(obj, mesh) if density else None
    if mirrors(matrix):
        loops = loops[:, ::-1]
    loops = numpy.ascontiguousarray(loops)
    points = transformed(points, matrix)
    if not numpy.isfinite(points).all():
        raise SourceError("it has vertices at places that are not finite")
    offsets = numpy.arange(0, 3 * len(loops) + 1, 3, dtype=numpy.int64)
    return Source(key_of(obj), MeshArrays(points, offsets, corners[loops.ravel()]), matrix, polygons, loops, carried, densities)


def new_mesh(name, made, matrix):
    """A mesh data-block from a level's MeshDict (world space), in the space of an object with this matrix. Raises MeshError."""
    points = in_object(made["points"], matrix)
    offsets = numpy.asarray(made["offsets"], dtype=numpy.int64)
    indices = numpy.asarray(made["indices"], dtype=numpy.int32)
    corners = corner_order(offsets, matrix)
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", points.ravel())
    mesh.loops.add(len(indices))
    mesh.loops.foreach_set("vertex_index", indices[corners])
    mesh.polygons.add(len(offsets) - 1)
    mesh.polygons.foreach_set("loop_start", offsets[:-1].astype(numpy.int32))
    mesh.polygons.foreach_set("loop_total", numpy.diff(offsets).astype(numpy.int32))
    mesh.polygons.foreach_set("use_smooth", numpy.ones(len(offsets) - 1, dtype=bool))
    mesh.update(calc_edges=True)
    if mesh.validate():
        # What the native side promises does not hold; better said here than seen as a damaged mesh.
        bpy.data.meshes.remove(mesh)
        raise MeshError(f"{name} is not a valid mesh")
    if "uv" in made:
        add_uv(mesh, PATCH_UV, numpy.asarray(made["uv"])[corners])
    if "sharp" in made:
        mark_sharp(mesh, numpy.asarray(made["sharp"])[edge_order(offsets, matrix)])
    return mesh


def in_object(points, matrix):
    """Points in world space as a mesh of an object with this matrix (object to world) has them: in single precision."""
    return transformed(points, numpy.linalg.inv(matrix)).astype(numpy.float32)


def in_world(places, matrix):
    """The places of a mesh's vertices in world space."""
    return transformed(places.astype(numpy.float64), matrix)


def set_places(mesh, places):
    """Puts the vertices of a mesh elsewhere. Returns whether any has moved."""
    if numpy.array_equal(values_of(mesh.vertices, "co", 3), places):
        return False
    mesh.vertices.foreach_set("co", numpy.ascontiguousarray(places).ravel())
    mesh.update()
    return True


def corner_order(offsets, matrix):
    """Which corner of a MeshDict is which of the mesh that new_mesh makes of it: faces are turned over where the object mirrors."""
    return reversed_corners(offsets) if mirrors(matrix) else slice(None)


def edge_order(offsets, matrix):
    """As corner_order, of the edges from each corner to the face's next."""
    return reversed_edges(offsets) if mirrors(matrix) else slice(None)


def mark_sharp(mesh, sharp):
    """Makes edges of a new mesh sharp (a bool a corner: the edge from it to the face's next one): marked as such, with normals split there and full creases."""
    if not sharp.any():
        return
    marked = numpy.zeros(len(mesh.edges), dtype=bool)
    marked[values_of(mesh.loops, "edge_index", 1, numpy.int32)[sharp]] = True
    collection, field = compat.new_sharp_edges(mesh)
    collection.foreach_set(field, marked)
    collection, field = compat.new_edge_creases(mesh)
    collection.foreach_set(field, marked.astype(numpy.float32))
    compat.split_normals(mesh)


def mark_seams(mesh, marked):
    """Sets which edges are seams, a bool an edge."""
    mesh.edges.foreach_set("use_seam", marked)


def add_uv(mesh, name, values):
    """Adds a UV map: one row a corner."""
    layer = mesh.uv_layers.new(name=name)
    if layer is None:
        return  # Blender takes eight.
    collection, field = compat.uv_values(layer)
    collection.foreach_set(field, numpy.ascontiguousarray(values, dtype=numpy.float32).ravel())


def set_materials(mesh, indices):
    """Sets the material index of every polygon."""
    mesh.polygons.foreach_set("material_index", numpy.ascontiguousarray(indices, dtype=numpy.int32))


def set_attribute(mesh, name, kind, domain, values):
    """Adds an attribute: kind FLOAT, INT, BOOLEAN, FLOAT_VECTOR, FLOAT_COLOR or BYTE_COLOR; one value (row) an element of the domain."""
    field, width, dtype = _ATTRIBUTES[kind]
    attribute = mesh.attributes.new(name, kind, domain)
    values = numpy.ascontiguousarray(values, dtype=dtype)
    if values.size != len(attribute.data) * width:
        raise ValueError(f"attribute {name}: {values.size} numbers for {len(attribute.data)} elements of {width}")
    attribute.data.foreach_set(field, values.ravel())


def get_attribute(mesh, name):
    """The values of an attribute as an array, or None."""
    attribute = mesh.attributes.get(name)
    if attribute is None or attribute.data_type not in _ATTRIBUTES:
        return None
    field, width, dtype = _ATTRIBUTES[attribute.data_type]
    values = values_of(attribute.data, field, width, dtype)
    return values


def face_numbers(obj, name):
    """The values of a whole-number face attribute of a mesh object, in Edit Mode of the mesh that is edited, as an array; or None."""
    if obj.mode == "EDIT":  # The attributes of the data-block are empty then.
        faces = bmesh.from_edit_mesh(obj.data).faces
        layer = faces.layers.int.get(name)
        return None if layer is None else numpy.fromiter((face[layer] for face in faces), numpy.int32, len(faces))
    attribute = obj.data.attributes.get(name)
    if attribute is None or attribute.data_type != "INT" or attribute.domain != "FACE":
        return None
    return get_attribute(obj.data, name)


def selected_faces(obj):
    """Whether each face of a mesh object is selected, as an array; in Edit Mode of the mesh that is edited."""
    if obj.mode == "EDIT":
        faces = bmesh.from_edit_mesh(obj.data).faces
        return numpy.fromiter((face.select for face in faces), bool, len(faces))
    return values_of(obj.data.polygons, "select", 1, bool)


def selected_vertices(obj):
    """(points in world space (n, 3), whether each lies on a boundary (n,)) of the vertices that are selected in a mesh object in Edit Mode."""
    chosen = [vertex for vertex in bmesh.from_edit_mesh(obj.data).verts if vertex.select]
    points = numpy.array([vertex.co for vertex in chosen], dtype=numpy.float64).reshape(-1, 3)
    return transformed(points, world_matrix(obj.matrix_world)), numpy.array([vertex.is_boundary for vertex in chosen], dtype=bool)


def quad_corners(obj, chosen):
    """Vertices of the faces that `chosen` (a bool a face) names, a row a face, from the first corner of its quad on as the hierarchy has it, whatever the mesh's
    order is; None where one of them has not four corners or the mesh has no map of its patches. In Edit Mode of the mesh that is edited."""
    edited = obj.mode == "EDIT"
    graph = bmesh.from_edit_mesh(obj.data) if edited else bmesh.new()
    try:
        if not edited:
            graph.from_mesh(obj.data)
        graph.verts.index_update()
        layer = graph.loops.layers.uv.get(PATCH_UV)
        faces = [face for face, is_chosen in zip(graph.faces, chosen) if is_chosen]
        if layer is None or any(len(face.loops) != 4 for face in faces):
            return None
        return [_from_first_corner(face, layer) for face in faces]
    finally:
        if not edited:
            graph.free()


def _from_first_corner(face, layer):
    # Quads lie upright in the map, as in their root quad's square.
    middle = sum((loop[layer].uv.copy() for loop in face.loops), mathutils.Vector((0, 0))) / 4
    found = [-1] * 4
    for loop in face.loops:
        right, up = (a > b for a, b in zip(loop[layer].uv, middle))
        found[(0, 3, 1, 2)[2 * right + up]] = loop.vert.index
    return found


def mesh_arrays(mesh):
    """A mesh data-block as it stands, polygons and all."""
    starts = values_of(mesh.polygons, "loop_start", 1, numpy.int32).astype(numpy.int64)
    totals = values_of(mesh.polygons, "loop_total", 1, numpy.int32).astype(numpy.int64)
    corners = values_of(mesh.loops, "vertex_index", 1, numpy.int32)
    offsets = numpy.concatenate([[0], numpy.cumsum(totals)]).astype(numpy.int64)
    order = numpy.repeat(starts - offsets[:-1], totals) + numpy.arange(offsets[-1])
    return MeshArrays(values_of(mesh.vertices, "co", 3).astype(numpy.float64), offsets, corners[order])


_ATTRIBUTES = {
    "FLOAT": ("value", 1, numpy.float32),
    "INT": ("value", 1, numpy.int32),
    "BOOLEAN": ("value", 1, bool),
    "FLOAT_VECTOR": ("vector", 3, numpy.float32),
    "FLOAT_COLOR": ("color", 4, numpy.float32),
    "BYTE_COLOR": ("color", 4, numpy.float32),
    "FLOAT2": ("vector", 2, numpy.float32),
}


def values_of(collection, field, width, dtype=numpy.float32):
    """A property of every element of a collection as an array, a row an element where it has several numbers."""
    values = numpy.empty(len(collection) * width, dtype=dtype)
    collection.foreach_get(field, values)
    return values.reshape(-1, width) if width > 1 else values
