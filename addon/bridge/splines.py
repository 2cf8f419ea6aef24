# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as polylines; no bpy."""

import numpy


def closed(points, cyclic):
    """A polyline; a cyclic one ends where it begins."""
    return numpy.concatenate([points, points[:1]]) if cyclic and len(points) > 1 else points


def catmull_rom(points, cyclic, resolution):
    """A uniform Catmull-Rom spline through (n, 3) points as a polyline of `resolution` pieces a segment. It passes through its points."""
    count = len(points)
    if count < 3:
        return closed(points, cyclic)
    begin = numpy.arange(count if cyclic else count - 1)

    def control(step):
        index = begin + step
        return points[index % count if cyclic else numpy.clip(index, 0, count - 1)][:, None]

    before, a, b, after = control(-1), control(0), control(1), control(2)
    t = _steps(resolution)
    curve = 0.5 * (2 * a + (b - before) * t + (2 * before - 5 * a + 4 * b - after) * t**2 + (3 * (a - b) + after - before) * t**3)
    return numpy.concatenate([curve.reshape(-1, 3), points[:1] if cyclic else points[-1:]])


def bezier(points, left, right, cyclic, resolution):
    """A cubic Bezier spline with the handles `left` and `right` of each of (n, 3) points, as a polyline of `resolution` pieces a segment."""
    count = len(points)
    if count < 2:
        return points
    begin = numpy.arange(count if cyclic else count - 1)
    end = (begin + 1) % count
    a, b, c, d = points[begin][:, None], right[begin][:, None], left[end][:, None], points[end][:, None]
    t = _steps(resolution)
    curve = (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
    return numpy.concatenate([curve.reshape(-1, 3), points[:1] if cyclic else points[-1:]])


def _steps(resolution):
    """Parameters in [0, 1) as (1, resolution, 1)."""
    pieces = max(int(resolution), 1)
    return (numpy.arange(pieces) / pieces)[None, :, None]
