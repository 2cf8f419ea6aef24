# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines to be drawn on ball-like objects: the edges of a cube as they are seen from the object's middle."""

import numpy

CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
EDGES = [(a, b) for i, a in enumerate(CORNERS) for b in CORNERS[i + 1 :] if sum(abs(p - q) for p, q in zip(a, b)) == 2]


def on_surface(obj, directions):
    """World-space points of an object's surface, in directions of its own space from its middle."""
    found = []
    for direction in directions:
        hit, place, _, _ = obj.ray_cast((0, 0, 0), tuple(float(value) for value in direction))
        assert hit
        found.append(obj.matrix_world @ place)
    return numpy.array(found)


def cube_lines(obj, count=9):
    """The twelve edges of the cube as lines on the object's surface."""
    return [on_surface(obj, numpy.linspace(*edge, count)) for edge in EDGES]
