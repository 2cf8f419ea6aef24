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


def mirrors(matrix):
    return numpy.linalg.det(matrix[:3, :3]) < 0


def transformed(points, matrix):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


def reversed_corners(offsets):
    """The permutation of the corners that turns every face over: new corner i is old corner result[i]."""
    counts = numpy.diff(offsets)
    turned = numpy.repeat(offsets[:-1] + offsets[1:] - 1, counts)
    return turned - numpy.arange(offsets[-1], dtype=offsets.dtype)


def closest_weights(points, triangles):
    """Barycentric weights of the points of (n, 3, 3) triangles that are nearest to (n, 3) points; within the triangle, up to rounding."""
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
    # Clamping and rescaling is not the exact nearest point outside, but never leaves the triangle.
    weights = numpy.clip(weights, 0, None)
    return weights / weights.sum(1, keepdims=True)
