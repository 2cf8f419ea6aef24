# SPDX-License-Identifier: GPL-3.0-or-later
import json

import numpy as np
import pytest
from hybrid_mesh import _native
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
    assert _native.find_loops(*torus(), longest=1e-3) == []


def test_given_loops_come_first():
    first, second = _native.find_loops(*two_tori())
    again = _native.find_loops(*two_tori(), given=[second["points"]])
    assert [loop["points"].tolist() for loop in again] == [second["points"].tolist(), first["points"].tolist()]
    with pytest.raises(_native.InvalidInput, match="loop 1 touches"):
        _native.find_loops(*two_tori(), given=[first["points"], first["points"]])


@pytest.mark.parametrize("given", [[[0, 1]], [[-1, 0, 1]], [[0, 1, 2**40]], [[[0, 1, 2]]], ["abc"], [[0.5, None]]])
def test_given_loops_that_are_none(given):
    with pytest.raises(_native.InvalidInput):
        _native.find_loops(*torus(), given=given)


@pytest.mark.parametrize("settings", [{"detour": 0}, {"detour": float("nan")}, {"longest": -1}])
def test_wrong_settings(settings):
    with pytest.raises(_native.InvalidInput):
        _native.find_loops(*torus(), **settings)


def test_a_stroke_is_snapped():
    (loop,) = _native.find_loops(*torus())
    stroke = loop["positions"][::2] * 1.001
    snapped = _native.snap_loop(*torus(), stroke, tighten=False)
    assert len(_native.find_loops(*torus(), given=[snapped])) == 1
    tight = _native.snap_loop(*torus(), stroke)
    assert len(tight) <= len(snapped)
    with pytest.raises(_native.Unsupported, match="leaves the surface"):
        _native.snap_loop(*two_tori(), [[0, 0, 0], [10, 0, 0], [10, 1, 0]])
    with pytest.raises(_native.InvalidInput):
        _native.snap_loop(*torus(), [[0, 0]])


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
