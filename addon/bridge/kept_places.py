# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a level's vertices lie on the mesh of the source, kept with the level's mesh, its copies, and the file: three vertices and their weights each."""

from dataclasses import dataclass

import numpy

_KEY = "hybrid_mesh_places"  # a custom property of the mesh


@dataclass
class KeptPlaces:
    corners: numpy.ndarray  # (n, 3) vertices of the source's evaluated mesh
    weights: numpy.ndarray  # (n, 3)
    source_vertices: int  # how many that mesh had


def keep(mesh, corners, weights, source_vertices):
    if _KEY in mesh:
        del mesh[_KEY]  # Blender 5.0 writes bytes over others up to the first zero alone.
    head = numpy.array([source_vertices], dtype="<i8").tobytes()
    mesh[_KEY] = head + numpy.asarray(corners, dtype="<i4").tobytes() + numpy.asarray(weights, dtype="<f4").tobytes()


def find(mesh):
    """The places of a mesh's vertices, or None: they are not known, or the mesh has other vertices by now."""
    data, count = mesh.get(_KEY), len(mesh.vertices)
    if not isinstance(data, bytes) or len(data) != 8 + 24 * count:
        return None
    source_vertices = int(numpy.frombuffer(data, "<i8", 1)[0])
    corners = numpy.frombuffer(data, "<i4", 3 * count, 8).reshape(-1, 3)
    weights = numpy.frombuffer(data, "<f4", 3 * count, 8 + 12 * count).reshape(-1, 3).astype(numpy.float64)
    if not numpy.isfinite(weights).all() or corners.min(initial=0) < 0 or corners.max(initial=-1) >= source_vertices:
        return None
    return KeptPlaces(corners, weights, source_vertices)
