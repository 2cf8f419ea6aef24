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
    length = _length(points)
    if between > gap or length <= _LEAST_LENGTH * between or length == 0:
        return None
    points = points[:-1] if between == 0 else points
    return points if len(points) >= 3 else None


def closed_lines(strokes, gap):
    """The closed lines that strokes make, each as its points and the places of its strokes in the list. A stroke whose own ends meet is one; others go on where the nearest end
    of another one is within the gap: who draws around an arm has to turn the view.
    """
    lines, left = [], []
    for number, stroke in enumerate(strokes):
        stroke = numpy.asarray(stroke, dtype=float)
        points = closed(stroke, gap)
        if points is not None:
            lines.append((points, [number]))
        elif len(stroke) >= 2 and numpy.isfinite(stroke).all():
            left.append((number, stroke))
    met = _met_ends([stroke for _, stroke in left], gap)
    seen = set()
    for begin in range(len(left)):
        # Along a stroke to its other end, on to the end that this one meets, until it is a stroke that was there already.
        chain, end = [], 2 * begin
        while end is not None and end // 2 not in seen:
            seen.add(end // 2)
            chain.append(end)
            end = met.get(end ^ 1)
        if end != 2 * begin or len(chain) < 2:
            continue
        pieces = [left[one // 2][1][:: -1 if one % 2 else 1] for one in chain]
        apart = [numpy.linalg.norm(after[0] - before[-1]) for before, after in zip(pieces, [*pieces[1:], pieces[0]], strict=True)]
        points = closed(numpy.concatenate(pieces), gap)
        if points is not None and sum(map(_length, pieces)) > _LEAST_LENGTH * max(apart):
            lines.append((points, sorted(left[one // 2][0] for one in chain)))
    return lines


def _met_ends(strokes, gap):
    """Which ends of strokes meet, nearest first, each one other: {end: end}; end 2 i is the first point of stroke i, 2 i + 1 its last one."""
    ends = numpy.array([place for stroke in strokes for place in (stroke[0], stroke[-1])]).reshape(-1, 3)
    distances = numpy.linalg.norm(ends[:, None] - ends[None], axis=2)
    pairs = [(distances[a, b], a, b) for a in range(len(ends)) for b in range(a + 1, len(ends)) if a // 2 != b // 2 and distances[a, b] <= gap]
    met = {}
    for _, a, b in sorted(pairs):
        if a not in met and b not in met:
            met[a], met[b] = b, a
    return met


def _length(points):
    return float(numpy.linalg.norm(numpy.diff(points, axis=0), axis=1).sum())


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
