# SPDX-License-Identifier: GPL-3.0-or-later
import random

import pytest
from hybrid_mesh.core import plans, regions


def grid(columns, rows, turns=None):
    """Quads of a grid, node (i, j) numbered 100 j + i, each beginning at any of its corners."""
    turns = turns or random.Random(1)
    found = []
    for j in range(rows):
        for i in range(columns):
            quad = [100 * j + i, 100 * j + i + 1, 100 * j + i + 101, 100 * j + i + 100]
            turn = turns.randrange(4)
            found.append(quad[turn:] + quad[:turn])
    return found


def nodes(quads, sides):
    return [quads[quad][side] for quad, side in sides]


def test_the_boundary_of_a_block_runs_counter_clockwise():
    quads = grid(2, 3)
    around = nodes(quads, regions.boundary(quads))
    expected = [0, 1, 2, 102, 202, 302, 301, 300, 200, 100]
    first = expected.index(around[0])
    assert around == expected[first:] + expected[:first]


def test_corners_are_told_from_straight_sides():
    quads = grid(3, 2)[:5]  # an L: the last quad of the upper row is missing
    sides = regions.boundary(quads)
    counts = dict(zip(nodes(quads, sides), regions.corner_counts(quads, sides)))
    assert {node for node, count in counts.items() if count == 1} == {0, 3, 103, 202, 200}
    assert [node for node, count in counts.items() if count == 3] == [102]


@pytest.mark.parametrize(
    "quads, message",
    [
        ([], "no boundary"),
        ([[0, 1, 2, 3], [0, 1, 2, 3]], "side by side"),
        ([[0, 1, 2, 3], [4, 5, 6, 7]], "parts"),
        ([[0, 1, 2, 3], [2, 4, 5, 6]], "touches itself"),
        ([quad for number, quad in enumerate(grid(3, 3)) if number != 4], "hole"),
    ],
)
def test_what_is_no_region(quads, message):
    with pytest.raises(plans.PlanError, match=message):
        regions.boundary(quads)


def test_a_copy_begins_where_corners_come_to_corners():
    model, region = grid(2, 3), grid(3, 2, random.Random(7))
    sides = regions.boundary(model)
    for first in range(len(sides)):
        counts = regions.corner_counts(model, sides[first:] + sides[:first])
        start = regions.copy_start(region, counts)
        around = regions.boundary(region)
        at = around.index(start)
        assert regions.corner_counts(region, around[at:] + around[:at]) == counts
        assert regions.copy_start(region, counts, 3) == around[(at + 3) % len(around)]
        assert regions.copy_start(region, counts, -len(around)) == start


def test_a_copy_needs_as_many_sides():
    with pytest.raises(plans.PlanError, match="has 8 sides.*10"):
        regions.copy_start(grid(2, 2), [1] * 10)
