# SPDX-License-Identifier: GPL-3.0-or-later
"""A human-like head as a sum of smooth implicit shapes. Needs numpy alone.

Two units from chin to crown, the face toward -y, z up."""

import numpy
from implicit_shapes import axes, chain, ellipsoid, limb, union, without


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
    shape = union(shape, chain(p, [(0.09, -0.775, 0.120), (0.25, -0.750, 0.170), (0.43, -0.60, 0.130)], [0.045, 0.050, 0.035]), 0.16)
    shape = union(shape, ellipsoid(p, (0.255, -0.650, -0.015), (0.140, 0.125, 0.110)), 0.03)
    lids = chain(p, [(0.13, -0.750, -0.045), (0.255, -0.785, -0.070), (0.375, -0.715, -0.045)], [0.012, 0.014, 0.010])
    shape = without(shape, lids, 0.03)

    nose = limb(p, (0, -0.78, 0.10), (0, -0.985, -0.30), 0.055, 0.075)
    nose = union(nose, limb(p, (0, -0.76, -0.02), (0, -0.84, -0.34), 0.090, 0.110), 0.10)
    nose = union(nose, ellipsoid(p, (0, -1.005, -0.330), (0.085, 0.085, 0.078)), 0.08)
    nose = union(nose, ellipsoid(p, (0.105, -0.90, -0.375), (0.065, 0.100, 0.062)), 0.06)
    shape = union(shape, nose, 0.08)
    shape = without(shape, ellipsoid(p, (0.058, -0.950, -0.440), (0.030, 0.058, 0.040)), 0.03)

    shape = union(shape, ellipsoid(p, (0, -0.66, -0.60), (0.26, 0.205, 0.21)), 0.16)
    upper = chain(p, [(0, -0.872, -0.588), (0.045, -0.872, -0.580), (0.22, -0.762, -0.625)], [0.044, 0.046, 0.016])
    lower = chain(p, [(0, -0.850, -0.680), (0.10, -0.830, -0.670), (0.20, -0.765, -0.640)], [0.056, 0.050, 0.014])
    shape = union(shape, upper, 0.04)
    shape = union(shape, lower, 0.04)
    gap = chain(p, [(0, -0.930, -0.630), (0.12, -0.895, -0.630), (0.23, -0.785, -0.634)], [0.018, 0.016, 0.010])
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
