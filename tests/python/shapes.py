# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes as (points, face_offsets, face_indices)."""

import numpy as np


def mesh_of(points, faces):
    sizes = [len(face) for face in faces]
    return (
        np.array(points, np.float64),
        np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        np.concatenate(faces).astype(np.int32),
    )


def cube():
    points = [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    return mesh_of(points, [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])


def grid(columns, rows, place, wrap_u=False, wrap_v=False):
    """Triangulated quads over the unit square, glued where asked; `place` maps (u, v) arrays to (n, 3)."""
    across, up = columns + (not wrap_u), rows + (not wrap_v)
    v, u = np.mgrid[0:up, 0:across]
    points = place(u.ravel() / columns, v.ravel() / rows)
    faces = []
    for j in range(rows):
        for i in range(columns):
            a, b = j * across + i, j * across + (i + 1) % across
            c, d = (j + 1) % up * across + (i + 1) % across, (j + 1) % up * across + i
            faces += [[a, b, c], [a, c, d]]
    return mesh_of(points, faces)


def sphere(n=24):
    """A closed surface of genus 0: a cube's faces, each n x n, blown up."""
    index, points, faces = {}, [], []

    def vertex(key):
        if key not in index:
            index[key] = len(points)
            p = np.array(key, float) / n * 2 - 1
            points.append(p / np.linalg.norm(p))
        return index[key]

    for axis in range(3):
        for side in (0, n):
            for i in range(n):
                for j in range(n):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        key = [0, 0, 0]
                        key[axis], key[(axis + 1) % 3], key[(axis + 2) % 3] = side, i + di, j + dj
                        corners.append(vertex(tuple(key)))
                    if side == 0:
                        corners.reverse()
                    faces += [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
    return mesh_of(points, faces)


def torus(columns=48, rows=24):
    def place(u, v):
        a, b = 2 * np.pi * u, 2 * np.pi * v
        r = 1 + 0.4 * np.cos(b)
        return np.stack([r * np.cos(a), r * np.sin(a), 0.4 * np.sin(b)], axis=1)

    return grid(columns, rows, place, wrap_u=True, wrap_v=True)


def bent_sheet(n=24):
    """A disk: one boundary loop."""
    return grid(n, n, lambda u, v: np.stack([u, v, 0.3 * np.sin(3 * u) * np.cos(2 * v)], axis=1))
