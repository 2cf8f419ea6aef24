# SPDX-License-Identifier: GPL-3.0-or-later
"""What a surface carries (UV maps, colours, vertex groups, attributes, materials), read of the source and brought over to a level."""

import functools
from dataclasses import dataclass, field

import numpy
from mathutils.bvhtree import BVHTree

from .. import compat
from . import kept_places, meshes
from .arrays import closest_weights, majority, matching_faces, triangle_neighbours, walk
from .seams import SeamedMap

_FLOATING = {"FLOAT", "FLOAT_VECTOR", "FLOAT_COLOR", "BYTE_COLOR"}
_WHOLE = {"INT", "BOOLEAN"}
_MOST_PULLED = 0.5  # of the faces: where more lie across a UV map's seams, it shows more of them than of itself
# What Blender and a level have of their own.
_OWN = {
    "position", "material_index", "sharp_face", "sharp_edge", "crease_edge", "custom_normal", meshes.STRETCH, meshes.STRETCH_COLOR, meshes.ANISOTROPY,
    meshes.PATCH_COLOR, meshes.ERROR_COLOR,
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


class Carrier:
    """Carries what a source's surface has to levels, as levels.build() has it done: carrier(obj, MeshDict).

    repaired: the mesh whose faces a MeshDict's source_face counts; repair moves no point, so its faces are found among the source's. Without it nothing but the
    places of the vertices tells where they lie on the source: each takes the nearest triangle.
    """

    def __init__(self, source, repaired=None):
        self._source, self._triangles = source, source.mesh.indices.reshape(-1, 3)
        self._faces = None if repaired is None else matching_faces(repaired[0], repaired[2].reshape(-1, 3), source.mesh.points, self._triangles)
        self._called = 0
        self._unserved = []  # numbers of the calls for levels on which the source's active UV map cannot serve

    def __call__(self, obj, arrays):
        self._called += 1
        if self._faces is not None and (arrays.get("source_face") is None or not len(self._faces)):
            return
        place = Places(self._source, arrays, self._places(arrays))
        place.carry(obj)
        self._carry_uvs(obj, place)
        if self._faces is not None:
            kept_places.keep(obj.data, place.corners, place.weights, len(self._source.mesh.points))

    def _places(self, arrays):
        points = numpy.asarray(arrays["points"])
        if self._faces is None:
            return self._nearest(points)
        found = arrays["source_face"]
        triangle = self._faces[numpy.clip(found, 0, len(self._faces) - 1)]
        triangle = numpy.where((found >= 0) & (triangle >= 0), triangle, 0)
        # The fit has moved the vertices a little since they were put on their triangles.
        return walk(points, triangle, self._source.mesh.points, self._triangles, self._neighbours)

    def _carry_uvs(self, obj, place):
        mesh, carried = obj.data, self._source.carried
        order = meshes.corner_order(place.offsets, self._source.matrix)
        for name, uv_map in self._maps.items():
            values, pulled = uv_map.from_places(place.points, place.triangle, place.weights, place.offsets, place.indices, self._nearest)
            meshes.add_uv(mesh, name, values[order])
            if name == carried.active_uv and name in mesh.uv_layers:
                serves = (uv_map.has_area and pulled.mean() <= _MOST_PULLED) or meshes.PATCH_UV not in mesh.uv_layers
                active = mesh.uv_layers[name if serves else meshes.PATCH_UV]
                mesh.uv_layers.active, active.active_render = active, True
                if not serves:
                    self._unserved.append(self._called - 1)

    def warning(self, level_names):
        """A line for people where the source's UV map cannot serve; empty where there is nothing to say. level_names: of the levels in the order of the calls."""
        if not self._unserved:
            return ""
        name = self._source.carried.active_uv
        why = f"most faces lie across its seams on {', '.join(level_names[number] for number in self._unserved)}" if self._maps[name].has_area else "most of its faces have no area in it"
        return f"the UV map {name!r} cannot serve: {why}; {meshes.PATCH_UV!r} is active there"

    @functools.cached_property
    def _maps(self):
        loops, mesh = self._source.triangle_loops, self._source.mesh
        return {name: SeamedMap(mesh.points, self._triangles, uv[loops], self._neighbours) for name, uv in self._source.carried.uvs.items()}

    @functools.cached_property
    def _neighbours(self):
        return triangle_neighbours(self._triangles)

    @functools.cached_property
    def _nearest(self):
        return nearest_triangles(self._source.mesh)


def nearest_triangles(mesh):
    """A function that finds, for points, the nearest triangle of triangle MeshArrays each."""
    tree = BVHTree.FromPolygons(mesh.points.tolist(), mesh.indices.reshape(-1, 3).tolist(), all_triangles=True)
    return lambda points: numpy.array([tree.find_nearest(point)[2] for point in numpy.asarray(points).tolist()], dtype=numpy.int64)


def distances(mesh):
    """A function that finds how far points are from triangle MeshArrays."""
    tree = BVHTree.FromPolygons(mesh.points.tolist(), mesh.indices.reshape(-1, 3).tolist(), all_triangles=True)
    return lambda points: numpy.array([tree.find_nearest(point)[3] for point in numpy.asarray(points).tolist()])


class Places:
    """Where each vertex of a level (a MeshDict) lies on the source: over which triangle, and with what weights of its corners."""

    def __init__(self, source, arrays, triangle):
        self.source, self.mesh, self.carried = source, source.mesh, source.carried
        self.points = numpy.asarray(arrays["points"])
        self.triangle = triangle
        self.corners = self.mesh.indices.reshape(-1, 3)[triangle]
        self.weights = closest_weights(self.points, self.mesh.points[self.corners])
        self.offsets, self.indices = numpy.asarray(arrays["offsets"]), numpy.asarray(arrays["indices"])

    def carry(self, obj):
        """All but UV maps."""
        mesh = obj.data
        polygon = self.source.triangle_polygons[self.triangle]
        if self.carried.materials.max(initial=0) > 0:
            meshes.set_materials(mesh, self.by_face(self.carried.materials[polygon]))
        active = mesh.color_attributes.active_color_name if mesh.color_attributes.active_color else ""
        for name, kind, domain, values in self.carried.attributes:
            if domain == "POINT":
                meshes.set_attribute(mesh, name, kind, domain, self.by_vertex(values))
            elif domain == "CORNER":
                corners = self.by_corner(values)
                meshes.set_attribute(mesh, name, kind, domain, corners[meshes.corner_order(self.offsets, self.source.matrix)])
            else:
                meshes.set_attribute(mesh, name, kind, domain, self.by_face(values[polygon]))
        if active:
            mesh.color_attributes.active_color_index = mesh.color_attributes.find(active)
        for name, weights in self.carried.groups.items():
            set_group(obj, name, self.by_vertex(weights))

    def by_vertex(self, values):
        return numpy.einsum("vk,vk...->v...", self.weights, values[self.corners])

    def by_corner(self, values):
        loops = self.source.triangle_loops[self.triangle]
        return numpy.einsum("vk,vk...->v...", self.weights, values[loops])[self.indices]

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
