# SPDX-License-Identifier: GPL-3.0-or-later
import json

import numpy
import pytest
from hybrid_mesh.core import loops, plans
from hybrid_mesh.core.colors import level_color

SQUARE = numpy.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)


def test_points_are_text_to_the_last_digit():
    points = numpy.random.default_rng(1).normal(size=(5, 3)) * [1e-9, 1, 1e9]
    assert numpy.array_equal(loops.from_text(loops.to_text(points)), points)


@pytest.mark.parametrize("text", ["", "no points", "[[0, 0, 0], [1, 0, 0]]", "[[0, 0], [1, 0], [0, 1]]", "[[0, 0, 0], [1, 0, 0], [0, 1]]", "[[0, 0, 0], [1, 0, 0], [0, 1, NaN]]", "3", "null"])
def test_text_that_is_no_loop(text):
    with pytest.raises(loops.LoopError, match="find the loops again"):
        loops.from_text(text)


def test_closed_strokes():
    assert numpy.array_equal(loops.closed([*SQUARE, SQUARE[0]], 0), SQUARE)
    assert len(loops.closed([*SQUARE, [0, 0.1, 0]], 0.2)) == 5
    assert loops.closed([*SQUARE, [0, 0.3, 0]], 0.2) is None
    # Short, with ends as near as that; a line of two points; a point; nothing finite.
    assert loops.closed(SQUARE[:3] * 0.1, 0.2) is None
    assert loops.closed(SQUARE[:2], 9) is None and loops.closed(SQUARE[[0, 0, 0, 0]], 1) is None and loops.closed(SQUARE * numpy.nan, 1) is None


def turned(numbers, line):
    """A closed line's points from one of them on, in one of the two directions."""
    line = numpy.asarray(line)
    return any(numpy.array_equal(numpy.roll(way, -first, axis=0), numbers) for way in (line, line[::-1]) for first in range(len(line)))


def test_strokes_go_on_where_others_end():
    around = numpy.array([[numpy.cos(a), numpy.sin(a), 0] for a in numpy.linspace(0, 2 * numpy.pi, 25)])
    front, back, beside = around[:13], around[12:], around[:, [2, 0, 1]] + 9
    for one, other in ((front, back), (front[::-1], back), (front, back[::-1])):
        ((line, numbers),) = loops.closed_lines([one, other], 0.01)
        assert numbers == [0, 1] and {tuple(point) for point in line.round(6)} == {tuple(point) for point in around.round(6)}
        sides = numpy.linalg.norm(line - numpy.roll(line, 1, axis=0), axis=1)
        assert sides.max() < 1.01 * numpy.linalg.norm(around[1] - around[0])
    # In thirds, beside one that is closed by itself, and one that is not.
    found = loops.closed_lines([around[16:], beside, around[:9], beside[:5] + 3, around[8:17]], 0.01)
    assert [numbers for _, numbers in found] == [[1], [0, 2, 4]] and turned(found[0][0], beside[:-1])
    # Half of it, what is too far apart, ends that meet one other only, and scribbles as short as the gap.
    assert loops.closed_lines([front], 0.01) == [] and loops.closed_lines([front, back * 1.02], 0.01) == []
    assert loops.closed_lines([front, back[:6], back[6:]], 0.01) == []
    assert loops.closed_lines([around[:2] * 0.01, around[1:3] * 0.01], 1) == []
    assert loops.closed_lines([], 1) == [] and loops.closed_lines([numpy.full((5, 3), numpy.nan)], 1) == []


def test_points_are_found_by_their_places():
    points = numpy.random.default_rng(2).normal(size=(500, 3))
    points[::7, 0] = 0.5  # many in a plane
    moved = points[[3, 70, 77]] + 1e-13
    assert loops.numbers_at(points, [*moved, [9, 9, 9]]).tolist() == [3, 70, 77, -1]
    assert numpy.array_equal(loops.moved_to(points, [*moved, [9, 9, 9]]), [*points[[3, 70, 77]], [9, 9, 9]])
    assert loops.numbers_at(numpy.zeros((0, 3)), SQUARE).tolist() == [-1] * 4


def test_a_plan_of_topology_alone():
    plan = json.loads(plans.topology_plan([(SQUARE, -1), (SQUARE[:3], 2)]))
    assert plan == {
        "format": "hybrid-mesh plan", "version": 1,
        "topology": [{"kind": "cut", "loops": [SQUARE.tolist()]}, {"kind": "cut", "loops": [SQUARE[:3].tolist()], "level": 2}],
    }  # fmt: skip
    assert json.loads(plans.topology_plan([]))["topology"] == []
    for wrong in ((SQUARE, 0), (SQUARE, 99), (SQUARE[:, :2], -1), (SQUARE + numpy.inf, -1)):
        with pytest.raises(plans.PlanError):
            plans.topology_plan([wrong])


def test_levels_have_colours_of_their_own():
    colors = [level_color(level) for level in range(-1, 9)]
    assert len(set(colors)) == len(colors) and all(0 <= value <= 1 for color in colors for value in color)
