# SPDX-License-Identifier: GPL-3.0-or-later
"""Grids of fine vertices over coarse quads, on a hierarchy made by hand."""

import numpy
import pytest
from hybrid_mesh.bridge import arrays, grids

CUBE = numpy.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])


def edges_of(quads):
    """(ends of edges, the edge from each corner)."""
    sides = numpy.sort(numpy.stack([quads, numpy.roll(quads, -1, axis=1)], axis=-1), axis=-1)
    ends, edge = numpy.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
    return ends, edge.reshape(quads.shape)


def subdivided(quads, paths, count):
    """One step as a hierarchy makes it: quads, their paths, and how many vertices there are."""
    edges, side = edges_of(quads)
    middle, centre = count + side, count + len(edges) + numpy.arange(len(quads))
    children = [numpy.stack([quads[:, i], middle[:, i], centre, middle[:, i - 1]], axis=1) for i in range(4)]
    # A child's first corner is the lower left one of its square, whichever corner of the parent it has.
    children = [numpy.roll(child, i, axis=1) for i, child in enumerate(children)]
    return numpy.stack(children, axis=1).reshape(-1, 4), (4 * paths[:, None] + numpy.arange(4)).ravel(), count + len(edges) + len(quads)


def hierarchy(steps):
    quads, paths, count = CUBE, numpy.ones(6, dtype=int), 8
    levels = [{"indices": quads.ravel(), "root": numpy.arange(6), "path": paths}]
    for _ in range(steps):
        quads, paths, count = subdivided(quads, paths, count)
        levels.append({"indices": quads.ravel(), "root": numpy.repeat(levels[-1]["root"], 4), "path": paths})
    return levels, count


@pytest.mark.parametrize("steps", [1, 2, 3])
def test_grids_of_both_kinds_are_glued_alike(steps):
    levels, count = hierarchy(steps)
    mine = grids.level_grids(levels[0], levels[-1], steps)
    assert grids.same_faces(grids.grid_faces(mine), levels[-1]["indices"].reshape(-1, 4))
    assert numpy.array_equal(mine[:, [0, 0, -1, -1], [0, -1, -1, 0]], CUBE)
    ends, sides = edges_of(CUBE)
    for corners, own, side in ((CUBE, mine, sides), (CUBE[:, ::-1], grids.turned_over(mine), sides[:, [2, 1, 0, 3]])):
        other = grids.subdivided_grids(corners, side, ends, 8, steps)
        order = grids.correspondence(other, own, count)
        # Every vertex has its own partner, and that of a coarse vertex is the vertex itself.
        assert numpy.array_equal(numpy.sort(order), numpy.arange(count)) and numpy.array_equal(order[:8], numpy.arange(8))


def test_levels_in_between():
    levels, count = hierarchy(3)
    grid = grids.level_grids(levels[1], levels[3], 2)
    assert grid.shape == (24, 5, 5) and len(numpy.unique(grid)) == count


def test_what_does_not_lie_over_one_another_is_refused():
    levels, count = hierarchy(2)
    with pytest.raises(grids.GridError, match="no regular refinement"):
        grids.level_grids(levels[0], levels[1], 2)
    with pytest.raises(grids.GridError, match="do not come of"):
        grids.level_grids({**levels[0], "root": numpy.arange(1, 7)}, levels[1], 1)
    mine = grids.level_grids(levels[0], levels[2], 2)
    with pytest.raises(grids.GridError, match="glued"):
        grids.correspondence(mine, mine[::-1], count)


def test_seams_lie_where_values_part():
    # Two quads side by side, whose common edge has one value at its lower end and two at its upper one.
    vertices, offsets = numpy.array([0, 1, 4, 3, 1, 2, 5, 4]), numpy.array([0, 4, 8])
    edges = numpy.array([0, 1, 2, 3, 4, 5, 6, 1])
    values = numpy.array([(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (2, 0), (2, 1), (1, 1)], dtype=float)
    following = arrays.following_corners(offsets)
    assert following.tolist() == [1, 2, 3, 0, 5, 6, 7, 4]
    assert not arrays.seam_edges(vertices, edges, following, values, 7).any()
    values[7] += 5
    assert numpy.nonzero(arrays.seam_edges(vertices, edges, following, values, 7))[0].tolist() == [1]
