# SPDX-License-Identifier: GPL-3.0-or-later
"""What a texture looks like on two objects that have the same UV map."""

import numpy
from conftest import module
from mathutils.bvhtree import BVHTree

_CHECKS = 16  # of a checker map, along a side
_PLACES = 4000


class Mapped:
    """The triangles of an object's mesh and the values (n, 3, 2) of one of its UV maps at their corners."""

    def __init__(self, obj, name):
        mesh, values_of = obj.data, module("bridge.meshes").values_of
        mesh.calc_loop_triangles()
        loops = values_of(mesh.loop_triangles, "loops", 3, numpy.int32)
        self.polygon = values_of(mesh.loop_triangles, "polygon_index", 1, numpy.int32)
        self.points = values_of(mesh.vertices, "co", 3).astype(float)[values_of(mesh.loops, "vertex_index", 1, numpy.int32)[loops]]
        self.uv = values_of(*module("compat").uv_values(mesh.uv_layers[name]), 2).astype(float)[loops]
        self._tree = BVHTree.FromPolygons(self.points.reshape(-1, 3).tolist(), numpy.arange(3 * len(loops)).reshape(-1, 3).tolist(), all_triangles=True)

    def sample(self):
        """(points, values) of places spread evenly over the surface."""
        random = numpy.random.default_rng(1)
        across = self.points[:, 1:] - self.points[:, :1]
        areas = numpy.linalg.norm(numpy.cross(across[:, 0], across[:, 1]), axis=1)
        triangle = random.choice(len(areas), _PLACES, p=areas / areas.sum())
        weights = random.dirichlet((1, 1, 1), _PLACES)
        return (numpy.einsum("nk,nki->ni", weights, values[triangle]) for values in (self.points, self.uv))

    def at(self, points):
        """(values, triangles) at the nearest places of the surface."""
        found = [self._tree.find_nearest(point) for point in points.tolist()]
        triangle = numpy.array([one[2] for one in found])
        weights = module("bridge.arrays").closest_weights(numpy.array([tuple(one[0]) for one in found]), self.points[triangle])
        return numpy.einsum("nk,nki->ni", weights, self.uv[triangle]), triangle

    def growth(self, triangle):
        """How much longer lines may become in the map, at triangles."""
        along = self.points[triangle][:, [1, 2, 0]] - self.points[triangle]
        across = self.uv[triangle][:, [1, 2, 0]] - self.uv[triangle]
        heights = numpy.linalg.norm(numpy.cross(along[:, 0], along[:, 1]), axis=1)[:, None] / numpy.linalg.norm(along, axis=2)
        return (numpy.linalg.norm(across, axis=2) / heights).max(1) + 1e-6


def checker_difference(source, made, name):
    """The mean difference of colours (0 and 1) where a checker map lies on an object and on one that was made of it."""
    points, values = Mapped(source, name).sample()
    return numpy.abs(_checker(values) - _checker(Mapped(made, name).at(points)[0])).mean()


def smeared_faces(source, made, name):
    """How many faces have an edge that is far longer in the map than the source's map has it along there."""
    surface, mesh = Mapped(source, name), Mapped(made, name)
    long = numpy.zeros(len(mesh.polygon), dtype=bool)
    for side in range(3):
        begin, end = mesh.points[:, side], mesh.points[:, (side + 1) % 3]
        most = numpy.max([surface.growth(surface.at(begin + share * (end - begin))[1]) for share in (0.01, 0.3, 0.5, 0.7, 0.99)], axis=0)
        long |= numpy.linalg.norm(mesh.uv[:, (side + 1) % 3] - mesh.uv[:, side], axis=1) > 3 * most * numpy.linalg.norm(end - begin, axis=1) + 1e-4
    return len(set(mesh.polygon[long]))


def islands_of_faces(source, made, name):
    """For each face of `made` the islands of the source's map that its corners lie in or on; None for beside them. The islands are apart from one another."""
    surface, mesh = Mapped(source, name), Mapped(made, name)
    arrays = module("bridge.arrays")
    corners = numpy.unique(surface.uv.reshape(-1, 2), axis=0, return_inverse=True)[1].reshape(-1, 3)
    islands = arrays.connected(arrays.triangle_neighbours(corners))
    flat = numpy.pad(surface.uv.reshape(-1, 2), ((0, 0), (0, 1))).tolist()
    tree = BVHTree.FromPolygons(flat, numpy.arange(len(flat)).reshape(-1, 3).tolist(), all_triangles=True)
    found = {}
    for polygon, corners in zip(mesh.polygon.tolist(), mesh.uv.tolist()):
        for corner in corners:
            _, _, triangle, distance = tree.find_nearest((*corner, 0))
            found.setdefault(polygon, set()).add(int(islands[triangle]) if distance < 1e-4 else None)
    return list(found.values())


def _checker(values):
    return numpy.floor(values * _CHECKS).sum(1) % 2
