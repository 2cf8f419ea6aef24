# SPDX-License-Identifier: GPL-3.0-or-later
"""Finer and finer versions of a triangle mesh, of about the same shape: for measuring how time grows with size."""

import numpy as np

ROUGHNESS = 0.05  # of the length of an edge: how far points are moved along their normals, by the standard deviation


def finer(points, triangles, seed):
    """A mesh of four times as many triangles, smoothed by Loop's rules and then roughened as scans are: always in the same way for a seed."""
    points, triangles = np.asarray(points, dtype=float), np.asarray(triangles, dtype=np.int64)
    corners = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)  # side k of a triangle: from corner k to the next
    edges, of_side, uses = np.unique(np.sort(corners, axis=1), axis=0, return_inverse=True, return_counts=True)
    of_side = of_side.reshape(-1, 3)
    inner = uses == 2  # everything else is treated as a boundary
    made = np.concatenate([_moved(points, edges, inner), _middles(points, triangles, edges, of_side, inner)])
    a, b, c = triangles.T
    ab, bc, ca = (len(points) + of_side).T
    faces = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1).reshape(-1, 3)
    return _roughened(made, faces, seed), faces


def _middles(points, triangles, edges, of_side, inner):
    middle = points[edges].mean(1)
    opposite = np.zeros_like(middle)
    for side in range(3):
        np.add.at(opposite, of_side[:, side], points[triangles[:, (side + 2) % 3]])
    middle[inner] = 0.75 * middle[inner] + 0.125 * opposite[inner]
    return middle


def _moved(points, edges, inner):
    """The old points, by Loop's rules for the inside and for boundaries."""
    on_boundary = np.zeros(len(points), dtype=bool)
    on_boundary[edges[~inner]] = True
    # A point looks along boundary edges alone if it lies on one.
    seen = np.concatenate([edges, edges[:, ::-1]])
    seen = seen[~on_boundary[seen[:, 0]] | ~np.concatenate([inner, inner])]
    count, total = np.bincount(seen[:, 0], minlength=len(points)), np.zeros_like(points)
    np.add.at(total, seen[:, 0], points[seen[:, 1]])
    weight = np.where(count == 3, 3 / 16, 3 / (8 * np.maximum(count, 1)))
    weight[on_boundary] = np.where(count[on_boundary] == 2, 1 / 8, 0)
    weight[count == 0] = 0
    return (1 - weight * count)[:, None] * points + weight[:, None] * total


def _roughened(points, triangles, seed):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    face_normals, normals = np.cross(b - a, c - a), np.zeros_like(points)
    for k in range(3):
        np.add.at(normals, triangles[:, k], face_normals)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)
    edge = np.linalg.norm(b - a, axis=1).mean()
    return points + ROUGHNESS * edge * np.random.default_rng(seed).standard_normal((len(points), 1)) * normals
