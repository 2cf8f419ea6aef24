# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth implicit shapes, and the triangles of a zero level set. Needs numpy alone. A distance is negative inside."""

import numpy

# A cube's six tetrahedra around its diagonal; corner k of a cube is (k & 1, k >> 1 & 1, k >> 2 & 1).
_TETRAHEDRA = numpy.array([(0, 1, 3, 7), (0, 1, 5, 7), (0, 2, 3, 7), (0, 2, 6, 7), (0, 4, 5, 7), (0, 4, 6, 7)])


def ellipsoid(points, middle, radii, turn=None):
    """Distance to an ellipsoid, exact to first order near its surface. turn: rows are the axes of the radii."""
    away = points - middle
    if turn is not None:
        away = away @ numpy.asarray(turn).T
    near = numpy.linalg.norm(away / numpy.asarray(radii), axis=-1)
    slope = numpy.linalg.norm(away / numpy.asarray(radii) ** 2, axis=-1)
    return near * (near - 1) / numpy.maximum(slope, 1e-9)


def limb(points, start, end, start_radius, end_radius):
    """Distance to a capsule whose radius changes evenly from one end to the other."""
    start, along = numpy.asarray(start), numpy.asarray(end) - numpy.asarray(start)
    away = points - start
    t = numpy.clip(away @ along / (along @ along), 0, 1)
    return numpy.linalg.norm(away - t[..., None] * along, axis=-1) - (start_radius + t * (end_radius - start_radius))


def block(points, middle, half, rounding, turn=None):
    """Distance to a box with rounded edges. half: of its sizes; turn: rows are its axes."""
    away = points - numpy.asarray(middle)
    if turn is not None:
        away = away @ numpy.asarray(turn).T
    away = numpy.abs(away) - (numpy.asarray(half) - rounding)
    return numpy.linalg.norm(numpy.maximum(away, 0), axis=-1) + numpy.minimum(away.max(axis=-1), 0) - rounding


def chain(points, places, radii):
    """Distance to limbs from place to place."""
    return numpy.minimum.reduce([limb(points, *places[k : k + 2], *radii[k : k + 2]) for k in range(len(places) - 1)])


def union(a, b, width):
    """The union of two shapes, rounded where they are within `width` of each other."""
    t = numpy.clip(0.5 + 0.5 * (b - a) / width, 0, 1)
    return b + t * (a - b) - width * t * (1 - t)


def without(a, b, width):
    """The first shape without the second, rounded."""
    return -union(-a, b, width)


def axes(forward, up):
    """Rows: three orthonormal axes, the first along `forward`, the last as near to `up` as that lets it be."""
    first = numpy.asarray(forward) / numpy.linalg.norm(forward)
    second = numpy.cross(up, first)
    second /= numpy.linalg.norm(second)
    return numpy.array([first, second, numpy.cross(first, second)])


def zero_set(distance, low, high, step):
    """Points and triangles, counter-clockwise seen from outside, of the surface where distance(points) is 0, by marching tetrahedra."""
    counts = numpy.ceil((numpy.asarray(high) - low) / step).astype(int) + 1
    lattice = numpy.stack(numpy.meshgrid(*map(numpy.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    places = numpy.asarray(low) + step * lattice
    # A crooked lattice leaves no pattern in the triangles. Its outermost layers stay, where a surface that is cut off has its boundary.
    inner = ((lattice > 0) & (lattice < counts - 1)).all(axis=1)
    places += 0.15 * step * numpy.random.default_rng(1).uniform(-1, 1, places.shape) * inner[:, None]
    values = numpy.concatenate([distance(part) for part in numpy.array_split(places, max(1, len(places) // 100_000))])
    strides = numpy.array([counts[1] * counts[2], counts[2], 1])
    offsets = numpy.array([[k & 1, k >> 1 & 1, k >> 2 & 1] for k in range(8)]) @ strides
    cubes = numpy.nonzero((lattice < counts - 1).all(axis=1))[0][:, None] + offsets
    inside = values < 0
    mixed = inside[cubes].sum(axis=1)
    cubes = cubes[(mixed > 0) & (mixed < 8)]
    tetrahedra = cubes[:, _TETRAHEDRA].reshape(-1, 4)
    # Corners inside come first.
    tetrahedra = numpy.take_along_axis(tetrahedra, numpy.argsort(~inside[tetrahedra], axis=1, kind="stable"), axis=1)
    number = inside[tetrahedra].sum(axis=1)
    one, two, three = (tetrahedra[number == count] for count in (1, 2, 3))
    faces = numpy.concatenate([
        one[:, [[0, 1], [0, 2], [0, 3]]], three[:, [[0, 3], [1, 3], [2, 3]]],
        two[:, [[0, 2], [0, 3], [1, 3]]], two[:, [[0, 2], [1, 3], [1, 2]]],
    ])  # fmt: skip
    edges, corners = numpy.unique(faces.reshape(-1, 2), axis=0, return_inverse=True)
    a, b = values[edges[:, 0]], values[edges[:, 1]]
    # Away from the lattice, so that no triangle is without area.
    t = numpy.clip(a / (a - b), 0.1, 0.9)[:, None]
    points = (1 - t) * places[edges[:, 0]] + t * places[edges[:, 1]]
    triangles = corners.reshape(-1, 3)
    outward = places[faces[:, :, 1]].mean(axis=1) - places[faces[:, :, 0]].mean(axis=1)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    turned = (numpy.cross(b - a, c - a) * outward).sum(axis=1) < 0
    triangles[turned] = triangles[turned][:, ::-1]
    return points, triangles


def evened(distance, points, triangles, step, rounds=4):
    """The points moved along the surface toward the middles of their neighbours, so that no triangle is a needle; those of a boundary stay."""
    sides = numpy.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    sides, faces = numpy.unique(sides, axis=0, return_counts=True)
    free = numpy.ones(len(points), dtype=bool)
    free[sides[faces == 1]] = False
    ends = numpy.concatenate([sides, sides[:, ::-1]])
    valence = numpy.bincount(ends[:, 0], minlength=len(points))[:, None]
    for _ in range(rounds):
        middle = numpy.stack([numpy.bincount(ends[:, 0], points[ends[:, 1], k], len(points)) for k in range(3)], axis=1) / valence
        moved = (points + middle) / 2
        away = distance(moved)
        slope = numpy.stack([distance(moved + h) - distance(moved - h) for h in 0.1 * step * numpy.eye(3)], axis=1) / (0.2 * step)
        moved -= (away / numpy.maximum((slope**2).sum(axis=1), 0.1))[:, None] * slope
        points = numpy.where(free[:, None], moved, points)
    return points
