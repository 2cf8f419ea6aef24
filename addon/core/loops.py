# SPDX-License-Identifier: GPL-3.0-or-later
"""Loops around handles and tunnels: closed lines, as text, as strokes and along a surface's points."""

import json

import numpy

_LEAST_LENGTH = 3  # times the gap: what a closed stroke has at least, so that a short line is none


class LoopError(ValueError):
    """A loop that cannot be used; the message says why."""


def to_text(points):
    return json.dumps(numpy.asarray(points, dtype=float).tolist())


def from_text(text):
    """(n, 3) points; raises LoopError where the text is not what to_text() makes of three points at least."""
    try:
        points = numpy.array(json.loads(text), dtype=float)
    except (ValueError, TypeError, RecursionError) as error:
        raise LoopError("a loop's points cannot be read; find the loops again") from error
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 3 or not numpy.isfinite(points).all():
        raise LoopError("a loop's points cannot be read; find the loops again")
    return points


def closed(points, gap):
    """The points of a stroke whose ends meet, each once; None where they are farther apart than `gap` or it goes around nothing."""
    points = numpy.asarray(points, dtype=float)
    if len(points) < 3 or not numpy.isfinite(points).all():
        return None
    between = numpy.linalg.norm(points[-1] - points[0])
    length = numpy.linalg.norm(numpy.diff(points, axis=0), axis=1).sum()
    if between > gap or length <= _LEAST_LENGTH * between or length == 0:
        return None
    points = points[:-1] if between == 0 else points
    return points if len(points) >= 3 else None


def numbers_at(points, places):
    """For each of (m, 3) places the number of the point that is there to within rounding, of several the nearest; -1 where there is none."""
    points, places = numpy.asarray(points, dtype=float), numpy.asarray(places, dtype=float)
    # What single-precision points are apart is more than a hundred times as far.
    tolerance = 1e-9 * max(float(numpy.abs(points).max(initial=0)), float(numpy.abs(places).max(initial=0)))
    order = numpy.argsort(points[:, 0], kind="stable")
    along = points[order, 0]
    begins = numpy.searchsorted(along, places[:, 0] - tolerance, side="left")
    ends = numpy.searchsorted(along, places[:, 0] + tolerance, side="right")
    found = numpy.full(len(places), -1)
    for number, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        near = order[begin:end]
        distances = numpy.linalg.norm(points[near] - places[number], axis=1)
        if len(near) and distances.min() <= tolerance:
            found[number] = near[distances.argmin()]
    return found


def moved_to(points, places):
    """Places that are points' to within rounding, exactly there: the native search then knows a cycle of a surface's points for what it is."""
    numbers = numbers_at(points, places)
    return numpy.where(numbers[:, None] >= 0, numpy.asarray(points, dtype=float)[numbers], places)
