# SPDX-License-Identifier: GPL-3.0-or-later
"""Arithmetic on mesh arrays; no bpy."""

from dataclasses import dataclass

import numpy


@dataclass
class MeshArrays:
    points: numpy.ndarray  # float64 (n, 3)
    offsets: numpy.ndarray  # int64 (m + 1,)
    indices: numpy.ndarray  # int32 (k,)

    def __iter__(self):
        return iter((self.points, self.offsets, self.indices))


class MatrixError(ValueError):
    """An object's transform that cannot be undone."""


def world_matrix(rows):
    """A 4 x 4 matrix in double precision; raises MatrixError where it flattens the object."""
    matrix = numpy.array(rows, dtype=numpy.float64)
    scale = numpy.linalg.norm(matrix[:3, :3], axis=0).prod()
    if not numpy.isfinite(matrix).all() or scale == 0 or abs(numpy.linalg.det(matrix[:3, :3])) < 1e-12 * scale:
        raise MatrixError("its scale is zero in a direction, so the result could not be put back")
    return matrix


def mirror_plane(matrix, axis):
    """The plane through the origin of an object with that matrix, across one of its axes (0 to 2), in world space: its normal and its offset along it.

    Raises MatrixError where what is symmetric in the object's space would not be so in world space.
    """
    across = numpy.linalg.inv(matrix)[axis, :3]
    normal = across / numpy.linalg.norm(across)
    along = matrix[:3, axis] / numpy.linalg.norm(matrix[:3, axis])
    if abs(abs(normal @ along) - 1) > 1e-9:
        raise MatrixError(f"its {'XYZ'[axis]} axis is sheared, so that mirror images across it are none in world space")
    return tuple((normal + 0.0).tolist()) + (float(normal @ matrix[:3, 3]) + 0.0,)


def mirrors(matrix):
    return numpy.linalg.det(matrix[:3, :3]) < 0


def transformed(points, matrix):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def reversed_corners(offsets):
    """The permutation of the corners that turns every face over: new corner i is old corner result[i]."""
    counts = numpy.diff(offsets)
    turned = numpy.repeat(offsets[:-1] + offsets[1:] - 1, counts)
    return turned - numpy.arange(offsets[-1], dtype=offsets.dtype)


def reversed_edges(offsets):
    """The same for edges, which go by the corner that they start from in their face: the edge from new corner i is that from old corner result[i]."""
    return reversed_corners(offsets)[following_corners(offsets)]


def following_corners(offsets):
    """The next corner of its face, for each corner."""
    following = numpy.arange(1, offsets[-1] + 1, dtype=offsets.dtype)
    following[offsets[1:] - 1] = offsets[:-1]
    return following


def closest_weights(points, triangles, inside=True):
    """Barycentric weights in (n, 3, 3) triangles of the points nearest to (n, 3) points: of the triangle, or of its plane."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    ab, ac, ap = b - a, c - a, points - a
    d00, d01, d11 = (ab * ab).sum(1), (ab * ac).sum(1), (ac * ac).sum(1)
    d20, d21 = (ap * ab).sum(1), (ap * ac).sum(1)
    determinant = d00 * d11 - d01 * d01
    safe = numpy.where(determinant > 0, determinant, 1)
    v = (d11 * d20 - d01 * d21) / safe
    w = (d00 * d21 - d01 * d20) / safe
    weights = numpy.stack([1 - v - w, v, w], axis=1)
    weights[determinant <= 0] = 1 / 3
    if not inside:
        return weights
    beyond = numpy.nonzero((weights < 0).any(1))[0]
    weights[beyond] = _on_edges(points[beyond], triangles[beyond])
    return weights


def _on_edges(points, triangles):
    """Barycentric weights of the points of triangles' edges that are nearest to points."""
    here = numpy.arange(len(points))
    best, least = numpy.zeros((len(points), 3)), numpy.full(len(points), numpy.inf)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        start, along = triangles[:, first], triangles[:, second] - triangles[:, first]
        square = (along * along).sum(1)
        share = numpy.clip(((points - start) * along).sum(1) / numpy.where(square > 0, square, 1), 0, 1)
        distance = numpy.linalg.norm(points - start - share[:, None] * along, axis=1)
        weights = numpy.zeros((len(points), 3))
        weights[here, first], weights[here, second] = 1 - share, share
        nearer = distance < least
        best[nearer], least[nearer] = weights[nearer], distance[nearer]
    return best


def triangle_neighbours(triangles):
    """(n, 3): the triangle across the edge opposite corner i, -1 where there is none or more than one."""
    triangles = numpy.asarray(triangles, dtype=numpy.int64)
    ends = numpy.stack([triangles[:, [1, 2]], triangles[:, [2, 0]], triangles[:, [0, 1]]], axis=1).reshape(-1, 2)
    keys = ends.min(1) * (triangles.max(initial=0) + 1) + ends.max(1)
    order = numpy.argsort(keys, kind="stable")
    same = keys[order][1:] == keys[order][:-1]
    begins = numpy.concatenate([[True], ~same])
    pair = numpy.nonzero(begins[:-1] & same & numpy.concatenate([~same[1:], [True]]))[0]
    across = numpy.full(len(keys), -1)
    across[order[pair]], across[order[pair + 1]] = order[pair + 1] // 3, order[pair] // 3
    return across.reshape(-1, 3)


def walk(points, triangle, mesh_points, triangles, neighbours, steps=32):
    """From a triangle near each point to the one that the point lies over: each step crosses the edge that the point is farthest beyond, of those that lead on."""
    triangle = numpy.array(triangle)
    moving = numpy.arange(len(points))
    came_from = numpy.full(len(points), -1)
    for _ in range(steps):
        weights = closest_weights(points[moving], mesh_points[triangles[triangle[moving]]], inside=False)
        ways = neighbours[triangle[moving]]
        side = numpy.where((ways >= 0) & (ways != came_from[moving][:, None]), weights, 0).argmin(1)
        ahead = ways[numpy.arange(len(moving)), side]
        go = (weights[numpy.arange(len(moving)), side] < -1e-9) & (ahead >= 0) & (ahead != came_from[moving])
        moving, ahead = moving[go], ahead[go]
        if not len(moving):
            break
        came_from[moving] = triangle[moving]
        triangle[moving] = ahead
    return triangle


def matching_faces(points, faces, other_points, other_faces):
    """For each triangle the number of the other mesh's triangle with the same three places as corners, -1 where there is none."""
    faces, other_faces = numpy.asarray(faces), numpy.asarray(other_faces)
    if faces.shape == other_faces.shape and numpy.array_equal(numpy.asarray(points)[faces], numpy.asarray(other_points)[other_faces]):
        return numpy.arange(len(faces))
    places = numpy.unique(numpy.concatenate([points, other_points]), axis=0, return_inverse=True)[1].ravel()
    keys = numpy.concatenate([numpy.sort(places[faces], axis=1), numpy.sort(places[len(points) :][other_faces], axis=1)])
    names = numpy.unique(keys, axis=0, return_inverse=True)[1].ravel()
    first = numpy.full(names.max(initial=-1) + 1, -1)
    first[names[len(faces) :][::-1]] = numpy.arange(len(other_faces))[::-1]
    return first[names[: len(faces)]]


def connected(neighbours):
    """The part of each triangle, by number: triangles hang together where they are neighbours, (n, 3) with -1 for none, both ways."""
    label = numpy.arange(len(neighbours))
    across = numpy.where(neighbours >= 0, neighbours, label[:, None])
    while True:
        lower = numpy.minimum(label, label[across].min(1, initial=len(label)))
        numpy.minimum.at(lower, label, lower.copy())
        # Labels of labels: the number of rounds grows with the logarithm of the distance.
        while not numpy.array_equal(lower, lower[lower]):
            lower = lower[lower]
        if numpy.array_equal(lower, label):
            return label
        label = lower


def seam_edges(corner_vertices, corner_edges, following, corner_values, edges):
    """Whether each of `edges` edges lies between faces that have different values (as of a UV map) at one of its ends.

    corner_vertices, corner_edges (k,): the vertex of each corner, and the edge from it to the face's next corner, which is `following`.
    """
    ends = numpy.concatenate([corner_vertices, corner_vertices[following]])
    values = numpy.unique(numpy.concatenate([corner_values, corner_values[following]]), axis=0, return_inverse=True)[1].ravel()
    # One value at an end of an edge, or several.
    places = numpy.stack([numpy.tile(corner_edges, 2).astype(numpy.int64), ends.astype(numpy.int64)], axis=1)
    places, place = numpy.unique(places, axis=0, return_inverse=True)
    least, most = numpy.full(len(places), len(values)), numpy.full(len(places), -1)
    numpy.minimum.at(least, place.ravel(), values)
    numpy.maximum.at(most, place.ravel(), values)
    marked = numpy.zeros(edges, dtype=bool)
    marked[places[least != most, 0]] = True
    return marked


def majority(values):
    """For each row the column of the value that is most frequent in it; the first of several."""
    return (values[:, :, None] == values[:, None, :]).sum(2).argmax(1)
