# SPDX-License-Identifier: GPL-3.0-or-later
"""The sharp edges of meshes of (points, offsets, indices), and how far those of a remesh are from those of its original.

An edge is sharp if the surface turns by more than an angle there, whatever mesh it is of and whoever has made it. So are those of a narrow hole that few
quads go around: what is false about a remesh says something beside others of as many vertices only. Lengths are in the meshes' unit."""

from dataclasses import dataclass

import numpy as np

ANGLE = 30.0  # degrees
CORNER_ANGLE = 40.0  # degrees by which a curve turns at a corner
AT_CORNER = 1e-6  # of the diagonal: so near to a corner a vertex is at it
SPACING = 1e-3  # of the diagonal, between the points at which curves are looked at
# A triangle lower than this, of the diagonal, has no direction of its own: rounded coordinates turn it.
NEEDLE = 1e-6
LOST = 5e-3  # of the diagonal: what is farther from all of the remesh's sharp edges is drawn as lost
BLOCK = 64  # points whose nearest edges are sought together


@dataclass
class Curves:
    """The sharp edges of a mesh."""

    points: np.ndarray  # (n, 3), all of the mesh
    edges: np.ndarray  # (m, 2)
    angles: np.ndarray  # (m), degrees by which the surface turns at each
    boundary: np.ndarray  # (k, 2), the edges at which the mesh ends


def diagonal(mesh):
    return float(np.linalg.norm(np.ptp(mesh[0], axis=0)))


def half_edges(mesh):
    """(from, to, face) of every side of every face."""
    _, offsets, indices = mesh
    following = np.arange(1, len(indices) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    return indices, indices[following], np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))


def edges_of(mesh):
    """The edges that exactly two faces share, and those of a single one: (vertices (m, 2), half-edges (m, 2), whether the two faces are oriented alike,
    vertices (k, 2) of the single ones)."""
    start, end, _ = half_edges(mesh)
    pairs = np.sort(np.stack([start, end], axis=1), axis=1)
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    pairs = pairs[order]
    first = np.flatnonzero(np.r_[True, (pairs[1:] != pairs[:-1]).any(axis=1)])
    uses = np.diff(np.r_[first, len(pairs)])
    two = first[uses == 2]
    sides = np.stack([order[two], order[two + 1]], axis=1)
    return pairs[two], sides, start[sides[:, 0]] != start[sides[:, 1]], pairs[first[uses == 1]]


def normals(mesh):
    """A unit normal a face, zero where it has none; a needle has that of the face beyond its longest side."""
    points, offsets, indices = mesh
    start, end, face = half_edges(mesh)
    away = points[start] - points[indices[offsets[:-1]]][face]  # from a corner of the face: small numbers lose nothing
    toward = points[end] - points[indices[offsets[:-1]]][face]
    areas = np.zeros((len(offsets) - 1, 3))
    np.add.at(areas, face, np.cross(away, toward) / 2)
    sizes = np.linalg.norm(areas, axis=1)
    lengths = np.linalg.norm(points[end] - points[start], axis=1)
    longest = np.zeros(len(areas))
    np.maximum.at(longest, face, lengths)
    needles = 2 * sizes <= NEEDLE * diagonal(mesh) * longest
    made = np.divide(areas, sizes[:, None], out=np.zeros_like(areas), where=~needles[:, None])
    if needles.any():
        _, sides, alike, _ = edges_of(mesh)
        for a, b in ((sides[:, 0], sides[:, 1]), (sides[:, 1], sides[:, 0])):
            sides_of_needles = needles[face[a]] & (lengths[a] == longest[face[a]])
            a, b, sign = a[sides_of_needles], b[sides_of_needles], np.where(alike, 1.0, -1.0)[sides_of_needles]
            for _ in range(8):  # needles lie beside needles
                bare = ~made[face[a]].any(axis=1)
                made[face[a[bare]]] = sign[bare, None] * made[face[b[bare]]]
    return made


def sharp_edges(mesh, angle=ANGLE):
    """The Curves at which the surface turns by more than an angle in degrees. Faces without a direction have no sharp edges."""
    vertices, sides, alike, boundary = edges_of(mesh)
    of_face, face = normals(mesh), half_edges(mesh)[2]
    a, b = of_face[face[sides[:, 0]]], of_face[face[sides[:, 1]]] * np.where(alike, 1.0, -1.0)[:, None]
    angles = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b)))
    sharp = (angles > angle) & a.any(axis=1) & b.any(axis=1)
    return Curves(np.asarray(mesh[0]), vertices[sharp], angles[sharp], boundary)


def corners(curves):
    """The vertices at which three curves or more meet, or one turns or reaches the boundary. Where one fades out there is no corner: a little more or less
    of an angle and it ends elsewhere."""
    at_boundary = set(curves.boundary.ravel().tolist())
    ends = [[] for _ in range(len(curves.points))]
    for a, b in curves.edges:
        ends[a].append(b)
        ends[b].append(a)
    found = []
    for vertex, others in enumerate(ends):
        if len(others) == 2:
            a, b = curves.points[vertex] - curves.points[others[0]], curves.points[others[1]] - curves.points[vertex]
            turn = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
        if len(others) > 2 or (others and vertex in at_boundary) or (len(others) == 2 and turn > CORNER_ANGLE):
            found.append(vertex)
    return np.array(found, np.int64)


def samples(curves, spacing):
    """Points along all edges, at most so far apart, with both ends: (points (n, 3), the edge of each, the length that each stands for)."""
    a, b = curves.points[curves.edges[:, 0]], curves.points[curves.edges[:, 1]]
    lengths = np.linalg.norm(b - a, axis=1)
    pieces = np.maximum(1, np.ceil(lengths / spacing).astype(np.int64))
    edge = np.repeat(np.arange(len(pieces)), pieces + 1)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(pieces + 1) - (pieces + 1), pieces + 1)
    share = (number / pieces[edge])[:, None]
    at_end = (number == 0) | (number == pieces[edge])
    return a[edge] * (1 - share) + b[edge] * share, edge, lengths[edge] / pieces[edge] * np.where(at_end, 0.5, 1.0)


def nearest(points, curves):
    """Of every point the distance to the nearest edge of the curves, and which it is; infinity and -1 where there are no curves."""
    distances, edges = np.full(len(points), np.inf), np.full(len(points), -1)
    if not len(curves.edges):
        return distances, edges
    a, b = curves.points[curves.edges[:, 0]], curves.points[curves.edges[:, 1]]
    middles, halves = (a + b) / 2, np.linalg.norm(b - a, axis=1) / 2
    for at in range(0, len(points), BLOCK):
        block = points[at : at + BLOCK]  # in their order along the edges, near one another for the most part
        middle = block.mean(axis=0)
        radius = np.linalg.norm(block - middle, axis=1).max()
        away = np.linalg.norm(middles - middle, axis=1)
        # What is farther than the whole of another edge is from everywhere in the block is nearest to none of its points.
        near = np.flatnonzero(away - halves - radius <= (away + halves + radius).min())
        from_start, along = block[:, None] - a[near], b[near] - a[near]
        squared = np.einsum("ij,ij->i", along, along)
        share = np.einsum("ijk,jk->ij", from_start, along) / np.where(squared > 0, squared, 1)
        gaps = np.linalg.norm(from_start - np.clip(share, 0, 1)[:, :, None] * along, axis=2)
        best = gaps.argmin(axis=1)
        distances[at : at + BLOCK], edges[at : at + BLOCK] = gaps[np.arange(len(block)), best], near[best]
    return distances, edges


def with_boundary(curves):
    """The curves and the boundary."""
    edges = np.concatenate([curves.edges, curves.boundary])
    return Curves(curves.points, edges, np.concatenate([curves.angles, np.zeros(len(curves.boundary))]), curves.boundary)


def one_way(a, b, spacing):
    """The largest distance from curves to others, and the mean one by length: 0 where there are no curves to be far from others, infinity where there are
    none to be near to."""
    points, _, weights = samples(a, spacing)
    if not len(points):
        return 0.0, 0.0
    distances, _ = nearest(points, b)
    return float(distances.max()), float(np.average(distances, weights=weights))


def lost_pieces(original, remesh, size):
    """The pieces, (n, 2, 3), of the original's curves that are farther than LOST of its diagonal `size` from the remesh's."""
    points, edge, _ = samples(original, SPACING * size)
    lost = nearest(points, remesh)[0] > LOST * size
    whole = lost[1:] & lost[:-1] & (edge[1:] == edge[:-1])
    return np.stack([points[:-1][whole], points[1:][whole]], axis=1)


def median(values, weights):
    order = np.argsort(values)
    return float(values[order][np.searchsorted(np.cumsum(weights[order]), weights.sum() / 2)])


def angle_error(original, remesh, spacing, reach):
    """Degrees, the median along the original's curves, by which the surface turns more or less at the remesh's nearest sharp edge; where there is none within
    reach it does not turn at all. None where the original has no curves."""
    points, edge, weights = samples(original, spacing)
    if not len(points):
        return None
    distances, other = nearest(points, remesh)
    turns = np.zeros(len(points))
    found = distances <= reach
    turns[found] = remesh.angles[other[found]]
    return median(np.abs(original.angles[edge] - turns), weights)


def corner_distances(original, points):
    """Of every corner of the original's curves the distance to the nearest of some points."""
    return np.array([np.linalg.norm(points - corner, axis=1).min() for corner in original.points[corners(original)]])


def measure(original, mesh, angle=ANGLE):
    """What became of the sharp edges of an original, a mesh whose points are all used, in a remesh. Lengths are fractions of the original's diagonal, right
    to half of SPACING: `missing` is the largest distance from the original's curves to the remesh's; `false` is the other way, where the original's
    boundary is as good as a sharp edge (a remesh that closes a seam may have one there); both with their mean. `corner_distance` is the median one from a
    corner to the nearest vertex."""
    before, after = sharp_edges(original, angle), sharp_edges(mesh, angle)
    size = diagonal(original)
    start, end, _ = half_edges(mesh)
    reach = float(np.median(np.linalg.norm(mesh[0][end] - mesh[0][start], axis=1)))
    missing, false = one_way(before, after, SPACING * size), one_way(after, with_boundary(before), SPACING * size)
    at_corners = corner_distances(before, mesh[0]) / size
    return {
        "missing": missing[0] / size,
        "missing_mean": missing[1] / size,
        "false": false[0] / size,
        "false_mean": false[1] / size,
        "corners_kept": int((at_corners <= AT_CORNER).sum()),
        "corners": len(at_corners),
        "corner_distance": float(np.median(at_corners)) if len(at_corners) else None,
        "angle_error": angle_error(before, after, SPACING * size, reach),
    }
