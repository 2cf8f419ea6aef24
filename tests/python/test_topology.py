# SPDX-License-Identifier: GPL-3.0-or-later
import json

import implicit_shapes
import numpy as np
import pytest
from hybrid_mesh import _native
from quality import scaled_jacobians
from shapes import cube, mesh_of, sphere, torus


def two_tori():
    points, offsets, indices = torus()
    return np.concatenate([points, points + [10, 0, 0]]), np.concatenate([offsets, offsets[1:] + offsets[-1]]), np.concatenate([indices, indices + len(points)])


def test_the_loop_of_a_torus():
    (loop,) = _native.find_loops(*torus())
    assert loop["points"].dtype == np.int32 and loop["positions"].shape == (len(loop["points"]), 3)
    assert np.array_equal(loop["positions"], torus()[0][loop["points"]])
    sides = loop["positions"] - np.roll(loop["positions"], -1, axis=0)
    assert loop["length"] == pytest.approx(np.linalg.norm(sides, axis=1).sum())
    assert loop["kind"] in ("handle", "tunnel")
    assert len(set(loop["points"].tolist())) == len(loop["points"])


def test_no_loops():
    assert _native.find_loops(*sphere(6)) == [] and _native.find_loops(*cube()) == []
    assert _native.find_loops(*torus(), longest=1e-3) == _native.find_loops(*torus(), longest=0) == []


def had(loop, drawn=False):
    return {"points": loop["positions"], "drawn": drawn}


def test_loops_that_are_there_come_first():
    first, second = _native.find_loops(*two_tori())
    assert not first["drawn"] and first["source"] == -1
    for drawn in (False, True):
        again = _native.find_loops(*two_tori(), [had(second, drawn)])
        assert [loop["points"].tolist() for loop in again] == [second["points"].tolist(), first["points"].tolist()]
        assert [(loop["drawn"], loop["source"]) for loop in again] == [(drawn, 0), (False, -1)]
    (alone,) = _native.find_loops(*two_tori(), [had(second)], longest=0)
    assert alone["points"].tolist() == second["points"].tolist() and alone["kind"] == second["kind"]
    with pytest.raises(_native.InvalidInput, match="loop 2 touches"):
        _native.find_loops(*two_tori(), [had(first, True), had(first, True)])


@pytest.mark.parametrize(
    "wrong",
    [
        {"loops": [{"points": [[0, 0, 0], [1, 0, 0]]}]}, {"loops": [{"drawn": True}]}, {"loops": [[[0, 0, 0], [1, 0, 0]]]}, {"loops": ["abc"]},
        {"loops": [{"points": [[0, 0, 0]], "drawn": True}]}, {"loops": [{"points": [[0, 0, 0], [1, 0, float("nan")]], "drawn": True}]}, {"strokes": [[[0, 0]]]},
        {"strokes": [[[0, 0, 0]]]}, {"strokes": ["abc"]}, {"detour": 0}, {"detour": float("nan")}, {"longest": -1}, {"longest": float("nan")},
    ],
)  # fmt: skip
def test_what_is_no_loop_and_no_setting(wrong):
    for search in (_native.find_loops, _native.start_find_loops):
        with pytest.raises(_native.InvalidInput):
            search(*torus(), **wrong).result()


def test_strokes_become_loops():
    (loop,) = _native.find_loops(*torus())
    stroke = loop["positions"][::2] * 1.001
    (drawn,) = _native.find_loops(*torus(), strokes=[stroke])
    assert drawn["drawn"] and drawn["source"] == -1 and drawn["length"] <= 1.001 * loop["length"] and drawn["kind"] == loop["kind"]
    # What was found gives way to it, and of two that are drawn the second one is refused.
    assert [(one["drawn"], one["source"]) for one in _native.find_loops(*torus(), [had(loop)], [stroke])] == [(True, -1)]
    with pytest.raises(_native.InvalidInput, match="stroke 2 (touches|separates)"):
        _native.find_loops(*torus(), strokes=[stroke, stroke])
    with pytest.raises(_native.Unsupported, match="stroke 1: .*leaves the surface"):
        _native.find_loops(*two_tori(), strokes=[[[0, 0, 0], [10, 0, 0], [10, 1, 0]]])


def test_a_search_as_a_job_tells_how_far_it_is():
    mesh = torus(500, 400)
    job = _native.start_find_loops(*mesh)
    seen, stages = [job.progress], {job.stage}
    while not job.wait(0.005):
        seen.append(job.progress)
        stages.add(job.stage)
    assert seen == sorted(seen) and 0 <= seen[0] and seen[-1] < 1 and job.progress == 1
    # It moves all the while, and not only from one end to the other.
    assert len({int(10 * value) for value in seen}) >= 5 and "finding loops" in stages
    (loop,) = job.result()
    (again,) = _native.find_loops(*mesh)
    assert loop["points"].tolist() == again["points"].tolist()


def test_a_search_ends_wherever_it_is():
    mesh = torus(500, 400)
    assert len(mesh[0]) >= 200_000
    for begun in (0, 0.05, 0.15, 0.3, 0.5, 0.7, 0.85):
        job = _native.start_find_loops(*mesh)
        while job.progress < begun and not job.wait(0.002):
            pass
        job.cancel()
        # Far longer than it takes, so that a busy machine fails no one; what the search had left to do is not done.
        assert job.wait(10) and job.progress < 1
        with pytest.raises(_native.Cancelled):
            job.result()


def test_everything_closed():
    points, offsets, indices = two_tori()
    hole = 30  # its first face is left out
    mesh = points, offsets[: len(offsets) - 1], np.delete(indices, slice(3 * hole, 3 * hole + 3))
    *closed, events, kinds = _native.close_topology(*mesh)
    topology = _native.topology(*closed)
    assert (topology["genus"], topology["components"], topology["boundary_loops"]) == (0, 1, 0)
    assert sorted(kinds) == ["boundary", "cut", "cut", "tube"]
    assert len(events) == len(closed[1]) - 1 and set(events) == {-1, 0, 1, 2, 3}


def test_noise_is_closed():
    *closed, handles = _native.close_noise(*two_tori(), 1e6)
    assert handles == 2 and _native.topology(*closed)["genus"] == 0
    assert _native.close_noise(*two_tori(), 1e-6)[3] == 0
    with pytest.raises(_native.InvalidInput):
        _native.close_noise(*two_tori(), 0)


def test_a_mesh_that_cannot_be_used():
    with pytest.raises(_native.InvalidInput):
        _native.find_loops(*mesh_of([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]))


def side_by_side(shapes):
    points, offsets, indices, first = [], [np.zeros(1, np.int64)], [], 0
    for number, (own, own_offsets, own_indices) in enumerate(shapes):
        points.append(own + [3.5 * (number % 2), 3.5 * (number // 2), 0])
        offsets.append(np.asarray(own_offsets[1:]) + offsets[-1][-1])
        indices.append(np.asarray(own_indices) + first)
        first += len(own)
    return np.concatenate(points), np.concatenate(offsets), np.concatenate(indices)


@pytest.mark.parametrize("refinement", ["uniform", "adaptive"])
def test_components_and_handles_of_one_ball(refinement):
    """Tori and balls joined to one component, of which a ball's base is made: they part, and their handles open, on finer levels."""
    mesh = side_by_side([torus(30, 15), sphere(8), torus(30, 15), sphere(8), torus(30, 15)])
    result = _native.remesh(*mesh, {"vertices": 6000, "refinement": refinement, "base": "min", "topology": "late", "components": "joined"})
    report = json.loads(result.report)
    levels = report["levels"]
    assert (levels[0]["components"], levels[0]["genus"], levels[0]["quads"]) == (1, 0, 6)
    assert (levels[-1]["components"], levels[-1]["genus"]) == (5, 3)
    assert len({(level["components"], level["genus"]) for level in levels}) > 1
    assert result.hierarchy.check() == []
    told = json.loads(result.hierarchy.info())["levels"]
    assert [(level["components"], level["genus"]) for level in told if level["name"].startswith("N")] == [
        (level["components"], level["genus"]) for level in levels
    ]
    # Faces know what has opened where they were put in: by the numbers of the report, which are the plan's.
    events = json.loads(result.plan)["topology"]
    told = [entry for kind in ("loops", "tubes", "boundaries") for entry in report["topology"][kind]]
    assert {entry["number"]: entry["level"] for entry in told} == {number: event["level"] for number, event in enumerate(events, 1)}
    hierarchy = result.hierarchy
    for name in hierarchy.level_names:
        level, depth = hierarchy.level(name), int(name[1:])
        assert level["opened"].shape == level["opened_level"].shape == level["patch"].shape
        for number in set(level["opened"].tolist()) - {0}:
            faces = level["opened"] == number
            assert set(level["opened_level"][faces].tolist()) == {events[number - 1]["level"]} and events[number - 1]["level"] <= depth
            assert level["irregular"][faces].all()
        assert not level["opened_level"][level["opened"] == 0].any()
    operations = [hierarchy.operation(i) for i in range(hierarchy.operation_count)]
    assert sorted(event for operation in operations for event in operation["opens"]) == list(range(len(events)))
    assert all(events[event]["level"] == operation["level"] for operation in operations for event in operation["opens"])


def ringed_ball(radius, away, thickness):
    """A ball, and a ring that has grown into it: a handle, whose tunnel is where the ring is free."""

    def distance(points):
        ring = points - [1 + away, 0, 0]
        ring = np.hypot(np.hypot(ring[..., 0], ring[..., 2]) - radius, ring[..., 1]) - thickness
        return implicit_shapes.union(np.linalg.norm(points, axis=-1) - 1, ring, 0.05)

    points, triangles = implicit_shapes.zero_set(distance, np.full(3, -1.3), np.array([1.5 + away + radius + thickness, 1.3, 1.3]), 0.04)
    return points, np.arange(0, triangles.size + 1, 3), triangles.astype(np.int32).ravel()


@pytest.mark.parametrize("shape", [(0.2, 0.05, 0.07), (0.25, 0.1, 0.09)])
def test_quads_are_well_shaped_where_a_handle_opens(shape):
    """One that would pinch or shear its quads waits for a finer level."""
    result = _native.remesh(*ringed_ball(*shape), {"vertices": 6000, "refinement": "adaptive", "base": "min", "topology": "late"})
    (loop,) = json.loads(result.report)["topology"]["loops"]
    assert loop["level"] > 0
    level = result.hierarchy.level(f"N{loop['level']}")
    shapes = scaled_jacobians([level[key] for key in ("points", "offsets", "indices")])[level["opened"] > 0]
    assert len(shapes) > 0
    assert np.percentile(shapes, 5) > 0.5


def test_nobody_knows_what_opened_in_a_file(tmp_path):
    """A file has the quads alone."""
    result = _native.remesh(*torus(30, 15), {"vertices": 1000, "base": "min"})
    assert "opened" in result.final_mesh()
    result.hierarchy.save(tmp_path / "torus.hmesh")
    loaded = _native.load_hierarchy(tmp_path / "torus.hmesh")
    assert "opened" not in loaded.final_mesh() and all(not loaded.operation(i)["opens"] for i in range(loaded.operation_count))
