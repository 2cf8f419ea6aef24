# SPDX-License-Identifier: GPL-3.0-or-later
import json
import time

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, sphere, torus


def triangles(mesh):
    """(points, (m, 3) faces) of a mesh of triangles."""
    points, _, indices = mesh
    return points, indices.reshape(-1, 3)


def distance_to(points, faces, p):
    """Distance of one point to a triangle mesh."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    ab, ac, ap = b - a, c - a, p - a
    d00, d01, d11 = (ab * ab).sum(1), (ab * ac).sum(1), (ac * ac).sum(1)
    d20, d21 = (ap * ab).sum(1), (ap * ac).sum(1)
    area = d00 * d11 - d01 * d01
    v, w = (d11 * d20 - d01 * d21) / area, (d00 * d21 - d01 * d20) / area
    inside = (v >= 0) & (w >= 0) & (v + w <= 1)
    best = np.linalg.norm(p - (a + v[:, None] * ab + w[:, None] * ac), axis=1)[inside].min(initial=np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        t = np.clip(((p - start) * along).sum(1) / (along * along).sum(1), 0, 1)
        best = min(best, np.linalg.norm(p - start - t[:, None] * along, axis=1).min())
    return best


def cube_strokes(rng, noise):
    """The edges of a cube, drawn roughly on the unit sphere."""
    strokes = []
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    for i, a in enumerate(corners):
        for b in corners[i + 1 :]:
            if np.abs(a - b).sum() != 2:
                continue
            t = np.linspace(rng.uniform(-0.02, 0.02), 1 + rng.uniform(-0.02, 0.02), 7)[:, None]
            line = a + t * (b - a)
            line /= np.linalg.norm(line, axis=1, keepdims=True)
            strokes.append({"points": line + rng.uniform(-noise, noise, line.shape), "fit": "tight"})
    return strokes


def test_a_layout_of_quads_is_the_base_of_a_remesh():
    mesh = sphere(12)
    drawn = _native.layout_plan(*triangles(mesh), cube_strokes(np.random.default_rng(1), 0.01))
    assert drawn["problems"] == [] and len(drawn["faces"]) == 6
    made = _native.remesh(*mesh, {"vertices": 2000, "plan": drawn["plan"]})
    base = made.hierarchy.level("N0")
    assert len(base["offsets"]) - 1 == 6
    again = _native.remesh(*mesh, {"vertices": 2000, "plan": made.plan})
    assert (again.final_mesh()["points"] == made.final_mesh()["points"]).all()
    # Every face has the address of a quad of its own.
    level = made.hierarchy.level("N2")
    assert set(zip(level["root"], level["path"])) == {(root, path) for root in range(6) for path in range(16, 32)}


def cube_diagonal():
    """Across a face of the cube of cube_strokes()."""
    a, b = np.array([1, -1, -1.0]), np.array([1, 1, 1.0])
    line = a + np.linspace(0, 1, 9)[:, None] * (b - a)
    return {"points": line / np.linalg.norm(line, axis=1, keepdims=True)}


def test_faces_of_more_than_four_sides_are_filled():
    mesh = sphere(12)
    strokes = cube_strokes(np.random.default_rng(1), 0.01)[1:]
    checked = _native.make_layout(*triangles(mesh), strokes)
    drawn = _native.layout_plan(*triangles(mesh), strokes)
    for result in (checked, drawn):
        assert result["problems"] == []
        assert sorted(zip(map(len, result["faces"]), result["quads"])) == [(4, 1)] * 4 + [(6, 2)]
    made = _native.remesh(*mesh, {"vertices": 2000, "plan": drawn["plan"]})
    assert len(made.hierarchy.level("N0")["offsets"]) - 1 == 6 and made.hierarchy.check() == []


def test_a_layout_of_other_faces_is_no_base():
    strokes = [*cube_strokes(np.random.default_rng(1), 0.01), cube_diagonal()]
    for make in (_native.layout_plan, _native.make_layout):
        drawn = make(*triangles(sphere(12)), strokes)
        assert drawn.get("plan", "") == "" and [p["kind"] for p in drawn["problems"]] == ["odd_sides"] * 2
        assert sorted(zip(map(len, drawn["faces"]), drawn["quads"])) == [(3, 0)] * 2 + [(4, 1)] * 5


def region_plan(mesh):
    plan = json.loads(_native.layout_plan(*triangles(mesh), cube_strokes(np.random.default_rng(1), 0.01))["plan"])
    plan["operations"] = [{"level": 1, "quads": ["0.0", "0.1", "0.2", "0.3"], "curves": []}]
    return plan


def test_a_region_is_filled_where_no_curves_are():
    mesh = sphere(12)
    made = _native.remesh(*mesh, {"levels": 2, "plan": json.dumps(region_plan(mesh))}).hierarchy
    assert made.check() == [] and made.operation_count == 1
    assert made.operation(0)["corners"] == 8 and len(made.operation(0)["new_quads"]) >= 4


def test_problems_of_a_region_come_with_their_places():
    mesh = sphere(12)
    plan = region_plan(mesh)
    # Between corners of the region that are opposite one another: two faces of five sides.
    corners = plan["base"]["quads"][0]
    plan["operations"][0]["curves"] = [{"points": [plan["base"]["nodes"][corners[0]], plan["base"]["nodes"][corners[2]]]}]
    with pytest.raises(_native.LayoutError) as caught:
        _native.remesh(*mesh, {"levels": 2, "plan": json.dumps(plan)})
    assert isinstance(caught.value, _native.InvalidInput)
    message, problems = caught.value.args
    assert "5 sides" in message and [p["kind"] for p in problems] == ["odd_sides"] * 2 and len(problems[0]["points"]) > 5


def check_layout(result, points, faces):
    size = np.linalg.norm(np.ptp(points, axis=0))
    assert set(result) == {"nodes", "curves", "faces", "quads", "problems"} and len(result["quads"]) == len(result["faces"])
    assert result["nodes"].dtype == np.float64 and result["nodes"].shape[1:] == (3,)
    used = []
    for curve in result["curves"]:
        line = curve["points"]
        assert line.ndim == 2 and line.shape[1] == 3 and len(line) >= 2
        assert np.array_equal(line[[0, -1]], result["nodes"][list(curve["nodes"])])
        assert curve["boundary"] == (curve["stroke"] < 0)
        assert max(distance_to(points, faces, p) for p in line[:: max(1, len(line) // 8)]) < 1e-9 * size
    for sides in result["faces"]:
        used += sides
    assert len(set(used)) == len(used)
    expected = {(c, True) for c in range(len(result["curves"]))}
    expected |= {(c, False) for c, curve in enumerate(result["curves"]) if not curve["boundary"]}
    assert set(used) == expected
    for problem in result["problems"]:
        assert set(problem) == {"kind", "message", "points", "stroke", "face"}
        assert problem["message"] and problem["points"].ndim == 2 and problem["points"].shape[1] == 3


def ends_of(curve, forward):
    a, b = curve["nodes"]
    return (a, b) if forward else (b, a)


def test_a_cube_on_a_sphere():
    points, faces = triangles(sphere())
    for seed in range(3):
        result = _native.make_layout(points, faces, cube_strokes(np.random.default_rng(seed), 0.015))
        check_layout(result, points, faces)
        assert result["problems"] == []
        assert len(result["nodes"]) == 8 and len(result["curves"]) == 12
        assert [len(sides) for sides in result["faces"]] == [4] * 6
        for sides in result["faces"]:
            ends = [ends_of(result["curves"][c], forward) for c, forward in sides]
            assert [b for _, b in ends] == [a for a, _ in ends[1:] + ends[:1]]
            # Counter-clockwise, seen from outside.
            corners = result["nodes"][[a for a, _ in ends]]
            assert np.dot(np.cross(corners[1] - corners[0], corners[2] - corners[0]), corners.mean(axis=0)) > 0


def test_tight_curves_are_shorter_than_drawn_ones():
    points, faces = triangles(sphere(40))
    angle = np.linspace(0, np.pi / 2, 40)
    wave = np.stack([np.cos(angle), np.sin(angle), 0.2 * np.sin(8 * angle)], axis=1)
    lengths = {}
    for fit in ("tight", "drawn"):
        result = _native.make_layout(points, faces, [{"points": wave, "fit": fit}])
        check_layout(result, points, faces)
        line = result["curves"][0]["points"]
        lengths[fit] = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
        if fit == "drawn":
            drawn = wave / np.linalg.norm(wave, axis=1, keepdims=True)
            assert max(np.linalg.norm(drawn - p, axis=1).min() for p in line) < 0.06
    assert lengths["tight"] == pytest.approx(np.pi / 2, rel=0.01) and lengths["drawn"] > 1.3 * lengths["tight"]


def test_problems_say_what_and_where():
    points, faces = triangles(sphere())
    line = np.array([[1, 0, 0], [1, 1, 0], [0, 1, 0]]) / np.array([[1], [np.sqrt(2)], [1]])
    broken = line.copy()
    broken[1, 2] = np.nan
    strokes = [{"points": p} for p in (line, broken, 5 * line, np.zeros((0, 3)), line[:1], line)]
    result = _native.make_layout(points, faces, strokes)
    check_layout(result, points, faces)
    kinds = [(p["kind"], p["stroke"]) for p in result["problems"]]
    assert kinds[:5] == [("unusable", 1), ("off_surface", 2), ("unusable", 3), ("unusable", 4), ("overlap", 5)]
    assert kinds[5:] == [("dangling", 0), ("dangling", 0)]
    ends = np.concatenate([p["points"] for p in result["problems"][5:]])
    assert {tuple(np.round(p)) for p in ends} == {(1, 0, 0), (0, 1, 0)}
    assert [p["kind"] for p in _native.make_layout(points, faces, [])["problems"]] == ["uncovered"]


def test_snap_is_relative():
    points, faces = triangles(bent_sheet())
    # Ends a twentieth of the diagonal before the boundary.
    line = np.stack([np.linspace(0.07, 0.93, 30), np.full(30, 0.5), np.zeros(30)], axis=1)
    line[:, 2] = 0.3 * np.sin(3 * line[:, 0]) * np.cos(2 * line[:, 1])
    near = _native.make_layout(points, faces, [{"points": line}], snap=0.08)
    far = _native.make_layout(points, faces, [{"points": line}])
    check_layout(near, points, faces)
    assert near["problems"] == [] and [len(f) for f in near["faces"]] == [4, 4]
    assert "dangling" in {p["kind"] for p in far["problems"]}


def test_loops_on_a_torus():
    points, faces = triangles(torus())
    a = np.linspace(0, 2 * np.pi, 60)

    def place(u, v):
        r = 1 + 0.4 * np.cos(v)
        return np.stack([r * np.cos(u), r * np.sin(u), 0.4 * np.sin(v) + 0 * u], axis=1)

    strokes = [place(a, np.full_like(a, v)) for v in (0.3, 2.2, 4.4)] + [place(np.full_like(a, u), a) for u in (0.2, 2.3, 4.1)]
    result = _native.make_layout(points, faces, [{"points": p, "fit": "drawn"} for p in strokes])
    check_layout(result, points, faces)
    assert result["problems"] == [] and len(result["nodes"]) == 9 and [len(f) for f in result["faces"]] == [4] * 9


@pytest.mark.parametrize(
    "strokes, message",
    [
        ([{}], "stroke 0 has no points"),
        ([[]], "stroke 0 must be a dict"),
        ([{"points": [[0, 0, 1]]}, {"points": [[0, 0]]}], "stroke 1"),
        ([{"points": "line"}], "stroke 0"),
        ([{"points": [[0, 0, 1]], "fit": "loose"}], "'loose'"),
        ([{"points": [[0, 0, 1]], "width": 1}], "'width'"),
    ],
)
def test_strokes_that_cannot_be_read(strokes, message):
    points, faces = triangles(sphere(4))
    with pytest.raises(_native.InvalidInput, match=message):
        _native.make_layout(points, faces, strokes)


def test_meshes_and_settings_that_cannot_be_used():
    points, faces = triangles(sphere(4))
    for bad in (faces.ravel(), faces + 1000, faces.astype(float), None):
        with pytest.raises(_native.InvalidInput):
            _native.make_layout(points, bad, [])
    for snap in (-1, 2, float("nan")):
        with pytest.raises(_native.InvalidInput, match="snap"):
            _native.make_layout(points, faces, [], snap=snap)


def test_a_layout_is_planned_by_a_job():
    mesh, strokes = sphere(12), cube_strokes(np.random.default_rng(1), 0.01)
    job = _native.start_layout_plan(*triangles(mesh), strokes)
    assert job.wait(60) and job.progress == 1
    expected = _native.layout_plan(*triangles(mesh), strokes)
    assert expected["plan"]
    for _ in range(2):
        assert job.result()["plan"] == expected["plan"] and (job.result()["nodes"] == expected["nodes"]).all()
    strokes[0]["points"] = strokes[0]["points"][:4]  # ends in nowhere
    broken = _native.start_layout_plan(*triangles(mesh), strokes).result()
    assert broken["plan"] == "" and broken["problems"]


def test_a_layout_job_ends_soon_after_it_is_cancelled():
    job = _native.start_layout_plan(*triangles(sphere(200)), cube_strokes(np.random.default_rng(1), 0.01))
    assert not job.wait(0.02)
    start = time.perf_counter()
    job.cancel()
    assert job.wait(30) and time.perf_counter() - start < 0.5
    with pytest.raises(_native.Cancelled):
        job.result()
