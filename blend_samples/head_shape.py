# SPDX-License-Identifier: GPL-3.0-or-later
"""A human-like head as a sum of smooth implicit shapes, and the triangles of a zero level set. Needs numpy alone.

Two units from chin to crown, the face toward -y, z up. A distance is negative inside."""

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


def _chain(points, places, radii):
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


def head(points):
    """The distance of points (n, 3) to the head; its neck reaches down to z = -1.8."""
    # Faces are never quite even.
    p = points + 0.012 * numpy.sin(points[:, [1, 2, 0]] * [2.1, 1.7, 2.6] + [0.4, 1.1, 2.0])
    p = numpy.stack([numpy.abs(p[:, 0]), p[:, 1], p[:, 2]], axis=1)

    skull = ellipsoid(p, (0, 0.13, 0.34), (0.68, 0.81, 0.66))
    skull = union(skull, ellipsoid(p, (0, -0.30, 0.34), (0.52, 0.49, 0.46)), 0.30)
    face = ellipsoid(p, (0, -0.34, -0.26), (0.50, 0.50, 0.60))
    face = union(face, ellipsoid(p, (0, 0.05, -0.20), (0.60, 0.50, 0.42)), 0.20)
    face = union(face, limb(p, (0.41, 0.00, -0.50), (0.12, -0.60, -0.85), 0.15, 0.14), 0.22)
    shape = union(skull, face, 0.22)
    shape = union(shape, ellipsoid(p, (0, -0.74, -0.86), (0.15, 0.13, 0.12)), 0.14)
    shape = union(shape, ellipsoid(p, (0.34, -0.58, -0.20), (0.17, 0.16, 0.12)), 0.18)

    neck = limb(p, (0, 0.18, -0.40), (0, 0.30, -1.9), 0.44, 0.47)
    neck = union(neck, limb(p, (0.44, 0.24, -0.42), (0.12, -0.10, -1.75), 0.09, 0.12), 0.14)
    neck = union(neck, limb(p, (0, -0.20, -1.02), (0, -0.17, -1.20), 0.06, 0.07), 0.16)
    shape = union(shape, neck, 0.18)

    # Sockets, brows, and eyes with their lids closed.
    shape = without(shape, ellipsoid(p, (0.26, -0.90, -0.01), (0.17, 0.17, 0.10)), 0.12)
    shape = union(shape, _chain(p, [(0.09, -0.775, 0.120), (0.25, -0.750, 0.170), (0.43, -0.60, 0.130)], [0.045, 0.050, 0.035]), 0.16)
    shape = union(shape, ellipsoid(p, (0.255, -0.650, -0.015), (0.140, 0.125, 0.110)), 0.03)
    lids = _chain(p, [(0.13, -0.750, -0.045), (0.255, -0.785, -0.070), (0.375, -0.715, -0.045)], [0.012, 0.014, 0.010])
    shape = without(shape, lids, 0.03)

    nose = limb(p, (0, -0.78, 0.10), (0, -0.985, -0.30), 0.055, 0.075)
    nose = union(nose, limb(p, (0, -0.76, -0.02), (0, -0.84, -0.34), 0.090, 0.110), 0.10)
    nose = union(nose, ellipsoid(p, (0, -1.005, -0.330), (0.085, 0.085, 0.078)), 0.08)
    nose = union(nose, ellipsoid(p, (0.105, -0.90, -0.375), (0.065, 0.100, 0.062)), 0.06)
    shape = union(shape, nose, 0.08)
    shape = without(shape, ellipsoid(p, (0.058, -0.950, -0.440), (0.030, 0.058, 0.040)), 0.03)

    shape = union(shape, ellipsoid(p, (0, -0.66, -0.60), (0.26, 0.205, 0.21)), 0.16)
    upper = _chain(p, [(0, -0.872, -0.588), (0.045, -0.872, -0.580), (0.22, -0.762, -0.625)], [0.044, 0.046, 0.016])
    lower = _chain(p, [(0, -0.850, -0.680), (0.10, -0.830, -0.670), (0.20, -0.765, -0.640)], [0.056, 0.050, 0.014])
    shape = union(shape, upper, 0.04)
    shape = union(shape, lower, 0.04)
    gap = _chain(p, [(0, -0.930, -0.630), (0.12, -0.895, -0.630), (0.23, -0.785, -0.634)], [0.018, 0.016, 0.010])
    shape = without(shape, gap, 0.03)
    shape = without(shape, limb(p, (0, -0.930, -0.45), (0, -0.925, -0.54), 0.020, 0.026), 0.04)

    # An ear: a leaf that stands off, hollow, with a rim and a lobe.
    turn = axes((0.88, -0.46, 0.06), (0.0, 0.22, 1.0))
    middle = numpy.array([0.665, 0.14, -0.08])
    ear = ellipsoid(p, middle, (0.050, 0.135, 0.235), turn)
    local = (p - middle) @ turn.T
    ring = numpy.linalg.norm(local[:, 1:] / [0.135, 0.235], axis=1)
    rim = numpy.hypot((ring - 0.93) * 0.16, local[:, 0] - 0.025) - 0.032
    ear = union(ear, rim, 0.03)
    ear = union(ear, limb(p, (0.54, 0.12, 0.02), (0.60, 0.13, -0.16), 0.08, 0.08), 0.08)
    ear = without(ear, ellipsoid(p, middle + [0.062, -0.045, -0.02], (0.072, 0.078, 0.140), turn), 0.035)
    ear = union(ear, ellipsoid(p, middle + [-0.02, -0.07, -0.235], (0.04, 0.06, 0.07), turn), 0.05)
    shape = union(shape, ear, 0.05)
    # Skin, and what a scanner makes of it.
    return shape + 0.002 * numpy.sin(23 * points[:, 0]) * numpy.sin(19 * points[:, 1] + 1) * numpy.sin(21 * points[:, 2] + 2)


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
