# SPDX-License-Identifier: GPL-3.0-or-later
"""A sitting cat whose tail curls into a ring and grows together with itself, as a sum of smooth implicit shapes: genus 1. Needs numpy alone.

Two units high, the face toward -y, z up, the tail in the plane x = 0."""

import numpy
from implicit_shapes import chain, ellipsoid, limb, union, without

# The middle of the tail, y and z, and its radius: from the root along the ground, up, and around a ring to the tip.
_RING, _RING_RADIUS = numpy.array([1.18, 1.08]), 0.40
_ROOT = [(0.42, 0.30, 0.17), (0.68, 0.19, 0.160), (0.96, 0.15, 0.155), (1.23, 0.24, 0.15), (1.43, 0.45, 0.145), (1.55, 0.72, 0.14)]
_STEPS = 8  # limbs from one of these places to the next


def _tail_line():
    """Places (n, 3) and radii (n) along the tail, and how many of them there are before the ring is halfway round."""
    angles = numpy.radians(numpy.linspace(-8, 304, 14))
    inward = numpy.linspace(0, 1, len(angles))
    around = _RING + ((1 - 0.06 * inward) * _RING_RADIUS)[:, None] * numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=1)
    knots = numpy.concatenate([_ROOT, numpy.concatenate([around, (0.135 - 0.045 * inward)[:, None]], axis=1)])
    # A Catmull-Rom spline through them all.
    ends = numpy.concatenate([[2 * knots[0] - knots[1]], knots, [2 * knots[-1] - knots[-2]]])
    t = numpy.linspace(0, 1, _STEPS, endpoint=False)[:, None]
    line = []
    for a, b, c, d in zip(ends, ends[1:], ends[2:], ends[3:]):
        line.append(b + t * (c - a) / 2 + t**2 * (a - 2.5 * b + 2 * c - d / 2) + t**3 * (1.5 * (b - c) + (d - a) / 2))
    line = numpy.concatenate([*line, knots[-1:]])
    places = numpy.stack([0 * line[:, 0], line[:, 0], line[:, 1]], axis=1)
    return places, line[:, 2], (len(_ROOT) + len(angles) // 2) * _STEPS


def _tail(points):
    places, radii, half = _tail_line()
    first = chain(points, places[: half + 1], radii[: half + 1])
    second = chain(points, places[half:], radii[half:])
    # Rounded where the tip meets the ring, and not where the halves follow one another.
    near = numpy.clip(1.6 - numpy.linalg.norm(points - places[-1], axis=1) / 0.25, 0, 1)
    return union(first, second, 0.005 + 0.09 * near)


def cat(points):
    """The distance of points (n, 3) to the cat, which stands on z = 0."""
    p = numpy.stack([numpy.abs(points[:, 0]), points[:, 1], points[:, 2]], axis=1)

    body = limb(p, (0, 0.22, 0.46), (0, -0.24, 1.02), 0.42, 0.30)
    body = union(body, limb(p, (0, -0.24, 1.00), (0, -0.34, 1.45), 0.25, 0.22), 0.20)
    thigh = ellipsoid(p, (0.30, 0.16, 0.37), (0.19, 0.36, 0.36))
    body = union(body, thigh, 0.12)
    body = union(body, ellipsoid(p, (0.37, -0.03, 0.085), (0.110, 0.25, 0.095)), 0.08)
    leg = limb(p, (0.15, -0.30, 0.95), (0.15, -0.50, 0.14), 0.16, 0.095)
    leg = union(leg, ellipsoid(p, (0.15, -0.60, 0.085), (0.105, 0.16, 0.090)), 0.08)
    body = union(body, leg, 0.10)
    shape = union(body, _tail(points), 0.12)

    head = ellipsoid(p, (0, -0.42, 1.60), (0.33, 0.29, 0.27))
    head = union(head, ellipsoid(p, (0.14, -0.50, 1.52), (0.17, 0.18, 0.15)), 0.10)
    head = union(head, ellipsoid(p, (0.055, -0.70, 1.50), (0.085, 0.085, 0.070)), 0.06)
    head = union(head, ellipsoid(p, (0, -0.75, 1.555), (0.045, 0.035, 0.030)), 0.04)
    head = without(head, ellipsoid(p, (0.14, -0.72, 1.645), (0.075, 0.06, 0.050)), 0.05)
    ear = limb(p, (0.19, -0.38, 1.76), (0.245, -0.35, 2.00), 0.115, 0.025)
    ear = union(ear, limb(p, (0.10, -0.38, 1.82), (0.235, -0.35, 1.99), 0.05, 0.025), 0.05)
    ear = without(ear, limb(p, (0.185, -0.53, 1.78), (0.24, -0.46, 1.97), 0.085, 0.02), 0.04)
    head = union(head, ear, 0.06)
    return union(shape, head, 0.10)
