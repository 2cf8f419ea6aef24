# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface carries (UV maps, colours, vertex groups, attributes, materials), read of the source and brought over to a level."""

from dataclasses import dataclass, field

import numpy
from mathutils.bvhtree import BVHTree

from .. import compat
from . import kept_places, meshes
from .arrays import closest_weights, majority, matching_faces, surface_islands, triangle_neighbours, walk

_FLOATING = {"FLOAT", "FLOAT_VECTOR", "FLOAT_COLOR", "BYTE_COLOR"}
_WHOLE = {"INT", "BOOLEAN"}
# What Blender and a level have of their own.
_OWN = {
    "position", "material_index", "sharp_face", "sharp_edge", "crease_edge", "custom_normal", meshes.STRETCH, meshes.STRETCH_COLOR, meshes.ANISOTROPY,
    meshes.PATCH, meshes.IRREGULAR, meshes.PATCH_UV, meshes.ROOT, meshes.PATH, meshes.OPENED, meshes.OPENED_LEVEL,
}  # fmt: skip


@dataclass
class Carried:
    """Values by the source's own elements."""

    uvs: dict = field(default_factory=dict)  # name: (corners, 2)
    active_uv: str = ""
    attributes: list = field(default_factory=list)  # (name, kind, domain, values)
    groups: dict = field(default_factory=dict)  # vertex group: (vertices,)
    materials: numpy.ndarray = None  # material index of each polygon


def collect(obj, mesh):
    """Everything that the evaluated mesh of an object carries."""
    carried = Carried(materials=meshes.values_of(mesh.polygons, "material_index", 1, numpy.int32))
    for layer in mesh.uv_layers:
        if layer.name != meshes.PATCH_UV:
            carried.uvs[layer.name] = meshes.values_of(*compat.uv_values(layer), 2)
    if mesh.uv_layers.active and mesh.uv_layers.active.name in carried.uvs:
        carried.active_uv = mesh.uv_layers.active.name
    for attribute in mesh.attributes:
        if attribute.name in _OWN or attribute.name in carried.uvs or attribute.name.startswith("."):
            continue
        floating = attribute.data_type in _FLOATING and attribute.domain in {"POINT", "CORNER", "FACE"}
        if floating or (attribute.data_type in _WHOLE and attribute.domain == "FACE"):
            values = meshes.get_attribute(mesh, attribute.name)
            carried.attributes.append((attribute.name, attribute.data_type, attribute.domain, values))
    carried.groups = group_weights(obj, mesh)
    return carried


def group_weights(obj, mesh):
    """Vertex groups of an object's evaluated mesh: name: (vertices,)."""
    names = [group.name for group in obj.vertex_groups]
    weights = numpy.zeros((len(names), len(mesh.vertices)), dtype=numpy.float32)
    for vertex in mesh.vertices if names else ():
        for element in vertex.groups:
            if element.group < len(names):
                weights[element.group, vertex.index] = element.weight
    return dict(zip(names, weights))


def set_group(obj, name, weights):
    """Gives an object a vertex group with these weights (vertices,), in the place of one of that name."""
    old = obj.vertex_groups.get(name)
    if old is not None:
        obj.vertex_groups.remove(old)
    group = obj.vertex_groups.new(name=name)
    for vertex in numpy.nonzero(weights > 0)[0]:
        group.add([int(vertex)], float(weights[vertex]), "REPLACE")


def carrier(source, repaired):
    """A function carry(obj, MeshDict) for levels.build.

    repaired: the mesh whose faces a MeshDict's source_face counts; repair moves no point, so its faces are found among the source's.
    """
    faces = matching_faces(repaired[0], repaired[2].reshape(-1, 3), source.mesh.points, source.mesh.indices.reshape(-1, 3))
    neighbours = triangle_neighbours(source.mesh.indices.reshape(-1, 3))
    islands = _islands(source)

    def carry(obj, arrays):
        found = arrays.get("source_face")
        if found is None or not len(faces):
            return
        triangle = faces[numpy.clip(found, 0, len(faces) - 1)]
        triangle = numpy.where((found >= 0) & (triangle >= 0), triangle, 0)
        # The fit has moved the vertices a little since they were put on their triangles.
        triangle = walk(numpy.asarray(arrays["points"]), triangle, source.mesh.points, source.mesh.indices.reshape(-1, 3), neighbours)
        place = Places(source, arrays, triangle)
        place.carry(obj, islands)
        kept_places.keep(obj.data, place.corners, place.weights, len(source.mesh.points))

    return carry


def nearest_carrier(source):
    """The same where nothing but the places of the vertices tells where they lie on the source: each takes the nearest one."""
    find, islands = nearest_triangles(source.mesh), _islands(source)

    def carry(obj, arrays):
        Places(source, arrays, find(arrays["points"])).carry(obj, islands)

    return carry


def nearest_triangles(mesh):
    """A function that finds, for points, the nearest triangle of triangle MeshArrays each."""
    tree = BVHTree.FromPolygons(mesh.points.tolist(), mesh.indices.reshape(-1, 3).tolist(), all_triangles=True)
    return lambda points: numpy.array([tree.find_nearest(point)[2] for point in numpy.asarray(points).tolist()], dtype=numpy.int64)


def _islands(source):
    return {name: surface_islands(source.mesh.indices, uv[source.triangle_loops].reshape(-1, 2)) for name, uv in source.carried.uvs.items()}


class Places:
    """Where each vertex of a level (a MeshDict) lies on the source: over which triangle, and with what weights of its corners."""

    def __init__(self, source, arrays, triangle):
        self.source, self.mesh, self.carried = source, source.mesh, source.carried
        self.points = numpy.asarray(arrays["points"])
        self.triangle = triangle
        self.corners = self.mesh.indices.reshape(-1, 3)[triangle]
        self.weights = closest_weights(self.points, self.mesh.points[self.corners])
        self.offsets, self.indices = numpy.asarray(arrays["offsets"]), numpy.asarray(arrays["indices"])

    def carry(self, obj, islands):
        mesh = obj.data
        polygon = self.source.triangle_polygons[self.triangle]
        if self.carried.materials.max(initial=0) > 0:
            meshes.set_materials(mesh, self.by_face(self.carried.materials[polygon]))
        for name, uv in self.carried.uvs.items():
            values = self.by_corner(uv, islands[name])
            meshes.add_uv(mesh, name, values[meshes.corner_order(self.offsets, self.source.matrix)])
        if self.carried.active_uv in mesh.uv_layers:
            mesh.uv_layers.active = mesh.uv_layers[self.carried.active_uv]
            mesh.uv_layers[self.carried.active_uv].active_render = True
        active = mesh.color_attributes.active_color_name if mesh.color_attributes.active_color else ""
        for name, kind, domain, values in self.carried.attributes:
            if domain == "POINT":
                meshes.set_attribute(mesh, name, kind, domain, self.by_vertex(values))
            elif domain == "CORNER":
                corners = self.by_corner(values, None)
                meshes.set_attribute(mesh, name, kind, domain, corners[meshes.corner_order(self.offsets, self.source.matrix)])
            else:
                meshes.set_attribute(mesh, name, kind, domain, self.by_face(values[polygon]))
        if active:
            mesh.color_attributes.active_color_index = mesh.color_attributes.find(active)
        for name, weights in self.carried.groups.items():
            set_group(obj, name, self.by_vertex(weights))

    def by_vertex(self, values):
        return numpy.einsum("vk,vk...->v...", self.weights, values[self.corners])

    def by_corner(self, values, islands):
        """Values of corners. Where a face lies across a seam all its corners take the side that most of them are on."""
        loops = self.source.triangle_loops[self.triangle]
        made = numpy.einsum("vk,vk...->v...", self.weights, values[loops])[self.indices]
        if islands is None:
            return made
        counts = numpy.diff(self.offsets)
        for count in numpy.unique(counts):
            chosen = numpy.nonzero(counts == count)[0]
            places = self.offsets[chosen][:, None] + numpy.arange(count)
            vertices = self.indices[places]
            sides = islands[self.triangle[vertices]]
            main = numpy.take_along_axis(sides, majority(sides)[:, None], 1)
            for corner in range(count):
                across = numpy.nonzero(sides[:, corner] != main[:, 0])[0]
                if len(across):
                    # The nearest corner of the face that is on the right side lends its triangle.
                    lender = numpy.take_along_axis(vertices[across], (sides[across] == main[across]).argmax(1)[:, None], 1)[:, 0]
                    made[places[across, corner]] = self.extended(values, self.triangle[lender], self.points[vertices[across, corner]])
        return made

    def extended(self, values, triangle, points):
        """Values of triangles at points beside them."""
        weights = closest_weights(points, self.mesh.points[self.mesh.indices.reshape(-1, 3)[triangle]], inside=False)
        return numpy.einsum("vk,vk...->v...", numpy.clip(weights, -3, 4), values[self.source.triangle_loops[triangle]])

    def by_face(self, values):
        """The value that most corners of each face have."""
        counts = numpy.diff(self.offsets)
        made = numpy.empty((len(counts), *values.shape[1:]), dtype=values.dtype)
        for count in numpy.unique(counts):
            chosen = numpy.nonzero(counts == count)[0]
            corners = values[self.indices[self.offsets[chosen][:, None] + numpy.arange(count)]]
            best = majority(corners if corners.ndim == 2 else corners[..., 0])
            made[chosen] = corners[numpy.arange(len(chosen)), best]
        return made
