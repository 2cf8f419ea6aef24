# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of a remesh that hold for any tool's output, as meshes of (points, offsets, indices)."""

import numpy as np


def scaled_jacobians(mesh):
    """Of every quad the least over its corners of the sine of the corner's angle, signed by the quad's normal (the cross product of its
    diagonals)."""
    points, offsets, indices = mesh
    starts = offsets[:-1][np.diff(offsets) == 4]
    corners = points[indices[starts[:, None] + np.arange(4)]]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    least = np.ones(len(corners))
    for i in range(4):
        a, b = corners[:, (i + 1) % 4] - corners[:, i], corners[:, (i + 3) % 4] - corners[:, i]
        scale = np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1) * np.linalg.norm(normal, axis=1)
        sine = np.einsum("ij,ij->i", np.cross(a, b), normal)
        least = np.minimum(least, np.divide(sine, scale, out=np.zeros_like(sine), where=scale > 0))
    return least


def edges_of(mesh):
    """Unordered pairs of vertices, and how many faces each has."""
    _, offsets, indices = mesh
    following = np.arange(1, len(indices) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    pairs = np.sort(np.stack([indices, indices[following]], axis=1), axis=1)
    return np.unique(pairs, axis=0, return_counts=True)


def irregular_vertices(mesh):
    """Interior vertices where other than four faces meet."""
    points, _, indices = mesh
    pairs, counts = edges_of(mesh)
    valence = np.bincount(indices, minlength=len(points))
    valence[pairs[counts == 1]] = 4
    return int(((valence != 0) & (valence != 4)).sum())


def measure(native, original, mesh):
    """A row's figures; `native` is the module that compares."""
    distance = native.compare(*original, *mesh)
    topology = native.topology(*mesh)
    jacobians = np.sort(scaled_jacobians(mesh))
    count = len(jacobians)
    return {
        "vertices": topology["vertices"],
        "l2": distance["l2"],
        "hausdorff": distance["hausdorff"],
        "boundary_hausdorff": distance["boundary_hausdorff"],
        "q": topology["vertices"] * distance["l2"],
        "irregular": irregular_vertices(mesh),
        "sj_p05": float(jacobians[count // 20]) if count else None,
        "sj_median": float(jacobians[count // 2]) if count else None,
        "inverted_percent": 100.0 * float((jacobians <= 0).sum()) / count if count else None,
        "not_quads": int((np.diff(mesh[1]) != 4).sum()),
        "nonmanifold": topology["nonmanifold_edges"] + topology["nonmanifold_vertices"],
    }
