# SPDX-License-Identifier: GPL-3.0-or-later
import json
import sys
import time

import numpy
import pytest
from hybrid_mesh import _native
from hybrid_mesh.core import loop_search, loops, plans, process
from hybrid_mesh.core.colors import level_color
from hybrid_mesh.core.process_job import ProcessJob

SQUARE = numpy.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
TRIANGLES = numpy.array([[0, 1, 2], [0, 2, 3]])
MESH = (SQUARE, numpy.array([0, 3, 6]), TRIANGLES.ravel().astype(numpy.int32))


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


def test_points_are_found_by_their_places():
    points = numpy.random.default_rng(2).normal(size=(500, 3))
    points[::7, 0] = 0.5  # many in a plane
    moved = points[[3, 70, 77]] + 1e-13
    assert loops.numbers_at(points, [*moved, [9, 9, 9]]).tolist() == [3, 70, 77, -1]
    assert numpy.array_equal(loops.moved_to(points, [*moved, [9, 9, 9]]), [*points[[3, 70, 77]], [9, 9, 9]])
    assert loops.numbers_at(numpy.zeros((0, 3)), SQUARE).tolist() == [-1] * 4


def test_cycles():
    assert loops.is_cycle([0, 1, 2, 3], TRIANGLES) and loops.is_cycle([2, 1, 0], TRIANGLES)
    for other in ([0, 1], [0, 1, 3], [0, 1, 2, 1], [0, 1, -1], [0, 1, 9]):
        assert not loops.is_cycle(other, TRIANGLES)


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


class Native:
    """find_loops() refuses given loops that share a point with one before, and finds one more at points 0, 1, 2 if it may."""

    InvalidInput, Unsupported = _native.InvalidInput, _native.Unsupported

    def repair(self, points, offsets, indices):
        return points, offsets, indices, {}

    def find_loops(self, points, offsets, indices, given=(), longest=numpy.inf):
        taken = set()
        for number, loop in enumerate(given):
            if taken & set(loop):
                raise self.InvalidInput(f"loop {number} touches a boundary or a loop before it")
            taken |= set(loop)
        found = [*given, *([] if longest < 1 or taken & {0, 1, 2} else [[0, 1, 2]])]
        return [{"positions": points[list(loop)], "length": 1.0, "kind": "tunnel"} for loop in found]

    def snap_loop(self, points, offsets, indices, stroke, tighten=True):
        if numpy.abs(stroke).max() > 5:
            raise self.Unsupported("the stroke leaves the surface")
        return [0, 2, 3]


@pytest.fixture
def search(monkeypatch):
    monkeypatch.setattr(loop_search, "native", Native)
    return lambda own, drawn, complete: [(loop["source"], loop["drawn"], len(loop["points"])) for loop in loop_search.search(MESH, own, drawn, complete)]


def test_a_search_for_loops(search):
    drawn, found, gone = ({"points": points.tolist(), "drawn": is_drawn} for points, is_drawn in ((SQUARE[:3], True), (SQUARE[[0, 2, 3]], False), (SQUARE + 9, False)))
    assert search([], [], True) == [(-1, False, 3)] and search([], [], False) == []
    assert search([drawn], [], True) == [(0, True, 3)]
    # What was found gives way to what is drawn, and what is not on the surface any more is forgotten.
    assert search([found, drawn, gone], [], False) == [(1, True, 3)]
    assert search([found], [SQUARE], False) == [(-1, True, 3)]
    assert search([gone], [SQUARE], False) == [(-1, True, 3)]


@pytest.mark.parametrize(
    "own, drawn, words",
    [
        ([SQUARE[:3]], [SQUARE], "stroke 1 touches a boundary"), ([], [SQUARE, SQUARE], "stroke 2 touches"), ([], [SQUARE + 9], "stroke 1: the stroke leaves"),
        ([SQUARE + 9], [], "loop 1 is not on the surface"), ([SQUARE[:3], SQUARE[:3]], [], "loop 2 touches"),
    ],
)  # fmt: skip
def test_what_is_drawn_is_never_dropped(search, own, drawn, words):
    with pytest.raises(loops.LoopError, match=words):
        search([{"points": points.tolist(), "drawn": True} for points in own], drawn, True)


JOB = {"kind": "find_loops", "loops": [], "strokes": [], "search": True}


def test_a_search_in_a_process_of_its_own():
    job = ProcessJob(JOB, MESH, "finding loops")
    assert job.stage == "finding loops" and 0 <= job.progress <= 1
    assert not job.wait(0) or job.done
    assert job.result() == {"loops": []} and job.wait() and job.done


def test_a_failure_is_one_line():
    job = ProcessJob({**JOB, "strokes": [(SQUARE + 9).tolist()]}, MESH, "")
    with pytest.raises(process.WorkerFailed, match="^stroke 1: the stroke leaves the surface$"):
        job.result()


def test_a_search_ends_at_once(monkeypatch):
    monkeypatch.setattr(process, "worker_command", lambda needs_bpy=False: [sys.executable, "-c", "import time; time.sleep(60)"])
    job = ProcessJob(JOB, MESH, "")
    time.sleep(0.3)
    began = time.monotonic()
    job.cancel()
    assert job.wait(5) and time.monotonic() - began < 1
    with pytest.raises(process.WorkerFailed, match="cancelled"):
        job.result()
