# SPDX-License-Identifier: GPL-3.0-or-later
"""A UV map on faces that lie across its seams: each face has the coordinates of one side. No bpy."""

import numpy

from .arrays import closest_weights, connected, walk

_AGREES = 0.25  # of a face's size in the map: coordinates that are off by less are no seam's doing
_FARTHEST = 4.0  # times its size, a triangle's coordinates are continued beyond it
_OVER = 1e-6  # of a triangle: what is beyond an edge by less lies on it
_SEAM = 1e-5  # Coordinates on both sides of an edge that differ by less are the same.


class SeamedMap:
    """A UV map of a triangle mesh. points, triangles (n, 3), values (n, 3, 2): the map at each triangle's corners; neighbours: triangle_neighbours()."""

    def __init__(self, points, triangles, values, neighbours):
        self.points, self.triangles, self.values, self.neighbours = points, triangles, values, neighbours
        self.uncut = _uncut_neighbours(triangles, values, neighbours)
        self.islands = connected(self.uncut)
        across = values[:, 1:] - values[:, :1]
        self.has_area = bool((numpy.linalg.det(across) != 0).mean() > 0.5)
        self._steps = 32 + int(numpy.sqrt(len(triangles)))

    def at(self, triangle, weights):
        return numpy.einsum("vk,vki->vi", weights, self.values[triangle])

    def continued(self, triangle, points):
        """The map at points beside triangles, as if it went on there."""
        weights = closest_weights(points, self.points[self.triangles[triangle]], inside=False)
        middle = 1 / 3
        scale = _FARTHEST / numpy.maximum(numpy.abs(weights - middle).max(1), _FARTHEST)
        return self.at(triangle, middle + (weights - middle) * scale[:, None])

    def from_places(self, points, triangle, weights, offsets, indices, nearest):
        """The map on another mesh: (values (corners, 2), whether each face lies across a seam and was pulled back to one side (faces,)).

        triangle, weights: where its vertices lie; nearest(points): the nearest triangles. The side is that under the middle of the face. What is beyond the seam
        is the other side's where that is the same but for whole numbers, by which textures repeat; else it is the seam's: nothing beside the island is shown.
        """
        own = self.at(triangle, weights)
        made, counts = own[indices], numpy.diff(offsets)
        pulled = numpy.zeros(len(counts), dtype=bool)
        for count in numpy.unique(counts):
            chosen = numpy.nonzero(counts == count)[0]
            chosen = chosen[self._torn(points, triangle, own, indices[offsets[chosen][:, None] + numpy.arange(count)])]
            if not len(chosen):
                continue
            places = offsets[chosen][:, None] + numpy.arange(count)
            vertices = indices[places]
            middle = points[vertices].mean(1)
            start = nearest(middle)
            for corner in range(count):
                vertex = vertices[:, corner]
                made[places[:, corner]], back = self._reached(start, middle, points[vertex], triangle[vertex], own[vertex])
                pulled[chosen[back]] = True
        return made, pulled

    def _torn(self, points, triangle, own, vertices):
        """Of faces (n, k), those whose corners do not have the values that the first one's triangle leads one to expect."""
        first = triangle[vertices[:, 0]]
        expected = numpy.stack([self.continued(first, points[vertices[:, corner]]) for corner in range(vertices.shape[1])], axis=1)
        size = numpy.linalg.norm(expected - expected[:, :1], axis=2).max(1)
        off = numpy.linalg.norm(own[vertices] - expected, axis=2).max(1)
        islands = self.islands[triangle[vertices]]
        return (off > _AGREES * size) | (islands != islands[:, :1]).any(1)

    def _reached(self, start, middle, points, triangle, own):
        """The map at points as the triangles `start` under the middles of their faces have it, and whether it was pulled back from beyond a seam."""
        last = walk(points, start, self.points, self.triangles, self.uncut, self._steps)
        corners = self.points[self.triangles[last]]
        beyond = closest_weights(points, corners, inside=False) < -_OVER
        on_seam = (beyond & (self.uncut[last] < 0) & (self.neighbours[last] >= 0)).any(1)
        arrived = ~beyond.any(1) | (last == triangle)
        last = self._nearest_of_island(last, points, ~arrived & on_seam)
        corners = self.points[self.triangles[last]]
        value = self.at(last, closest_weights(points, corners))
        expected = self.continued(last, points)
        turned = own + numpy.round(expected - own)
        same_island = self.islands[triangle] == self.islands[start]
        off = numpy.linalg.norm(turned - expected, axis=1)
        size = numpy.linalg.norm(expected - self.continued(start, middle), axis=1)
        near = off <= numpy.where(same_island, 2 * _AGREES, _AGREES / 4) * size
        # Neither there nor at a seam: beyond the surface's boundary, or the way there is too winding.
        lost = ~arrived & ~near & ~on_seam & same_island & (off <= size)
        value = numpy.where((~arrived & (near | lost))[:, None], turned, value)
        return value, ~arrived & ~near & ~lost


    def _nearest_of_island(self, triangle, points, which):
        """From triangles near points to the nearest ones that no seam parts from them, for those of `which`."""
        triangle = triangle.copy()
        moving = numpy.nonzero(which)[0]
        for _ in range(self._steps):
            if not len(moving):
                break
            around = triangle[moving][:, None]
            for _ in range(3):  # As far as to the other side of a vertex.
                ways = self.uncut[around].reshape(len(moving), -1)
                around = numpy.concatenate([around, numpy.where(ways >= 0, ways, around[:, :1])], axis=1)
            places = numpy.repeat(points[moving], around.shape[1], axis=0)
            corners = self.points[self.triangles[around.ravel()]]
            off = numpy.linalg.norm(numpy.einsum("vk,vki->vi", closest_weights(places, corners), corners) - places, axis=1).reshape(around.shape)
            best = around[numpy.arange(len(moving)), off.argmin(1)]
            goes = off.min(1) < off[:, 0]
            triangle[moving] = numpy.where(goes, best, triangle[moving])
            moving = moving[goes]
        return triangle


def _uncut_neighbours(triangles, values, neighbours):
    """The neighbours of triangles, -1 also where the map has a seam between them."""
    uncut = neighbours.copy()
    here = numpy.arange(len(triangles))
    for side in range(3):
        across = neighbours[:, side]
        known = here[across >= 0]
        for corner in ((side + 1) % 3, (side + 2) % 3):
            other = across[known]
            same = (triangles[other] == triangles[known, corner][:, None]).argmax(1)
            uncut[known[(numpy.abs(values[other, same] - values[known, corner]) > _SEAM).any(1)], side] = -1
    return uncut
