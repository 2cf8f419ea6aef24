# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, sphere, torus


@pytest.fixture(scope="module")
def closed():
    return _native.remesh(*sphere(), {"vertices": 2000}).hierarchy


@pytest.fixture(scope="module")
def open_sheet():
    return _native.remesh(*bent_sheet(), {"vertices": 1000}).hierarchy


@pytest.fixture(scope="module")
def adaptive():
    return _native.remesh(*torus(), {"vertices": 1500, "refinement": "adaptive"}).hierarchy


def depth(hierarchy):
    return int(hierarchy.level_names[-1][1:])


def same_faces(a, b):
    return np.array_equal(a["offsets"], b["offsets"]) and np.array_equal(a["indices"], b["indices"])


def distance_to_nearest(points, others):
    return max(np.sqrt(((others - point) ** 2).sum(axis=1).min()) for point in points)


def test_subdivision_to_the_same_level_is_the_level(closed, open_sheet):
    for hierarchy in (closed, open_sheet):
        for level in range(depth(hierarchy) + 1):
            ours, theirs = hierarchy.subdivide(level, level), hierarchy.level(f"N{level}")
            assert ours.keys() == theirs.keys() - {"opened", "opened_level"}
            assert all(np.array_equal(ours[key], theirs[key]) for key in ours)


def test_the_result_has_the_faces_of_its_level(closed, open_sheet):
    for hierarchy in (closed, open_sheet):
        top = depth(hierarchy)
        mesh = hierarchy.subdivide(0, top)
        assert same_faces(mesh, hierarchy.level(f"N{top}")) and np.array_equal(mesh["patch"], hierarchy.level(f"N{top}")["patch"])
        # Catmull-Clark points are means of those they come from.
        base = hierarchy.level("N0")["points"]
        assert (mesh["points"] <= base.max(axis=0) + 1e-12).all() and (mesh["points"] >= base.min(axis=0) - 1e-12).all()
        finer = hierarchy.subdivide(0, top + 1)
        assert len(finer["offsets"]) - 1 == 4 * (len(mesh["offsets"]) - 1) and "normals" not in finer
        for entry in ("stretch", "anisotropy", "patch", "irregular"):
            assert len(finer[entry]) == len(finer["offsets"]) - 1
        assert len(finer["uv"]) == len(finer["indices"]) and len(finer["source_face"]) == len(finer["points"])
        assert (finer["source_face"] >= 0).all()


def test_the_limit_is_the_same_from_every_level(closed, open_sheet):
    for hierarchy in (closed, open_sheet):
        coarse, fine = (hierarchy.subdivide(0, level, limit=True) for level in (1, 2))
        assert distance_to_nearest(coarse["points"], fine["points"]) < 1e-12
        for mesh in (coarse, fine):
            assert mesh["normals"].shape == mesh["points"].shape
            assert np.allclose(np.linalg.norm(mesh["normals"], axis=1), 1)


def test_normals_point_outwards(closed):
    mesh = closed.subdivide(1, 3, limit=True)
    outwards = mesh["points"] / np.linalg.norm(mesh["points"], axis=1)[:, None]
    assert ((mesh["normals"] * outwards).sum(axis=1) > 0.9).all()


def test_points_can_be_given(closed):
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    base = closed.level("N1")["points"]
    here = closed.subdivide(1, 2, limit=True)
    for points in (base @ turn.T + 5, (base @ turn.T + 5).tolist()):
        there = closed.subdivide(1, 2, limit=True, points=points)
        assert np.allclose(here["points"] @ turn.T + 5, there["points"], atol=1e-12)
        assert np.allclose(here["normals"] @ turn.T, there["normals"], atol=1e-9)


def test_corners_and_creases_stay_sharp(closed, open_sheet):
    base = closed.level("N0")
    corner = int(base["indices"][0])
    sharp = closed.subdivide(0, 3, limit=True, corners=[(corner, 10)])
    assert distance_to_nearest(base["points"][[corner]], sharp["points"]) < 1e-12
    smooth = closed.subdivide(0, 3, limit=True)
    assert distance_to_nearest(base["points"][[corner]], smooth["points"]) > 1e-3
    # The edges of a face as a crease: its curve does not depend on any other point.
    face = base["indices"][base["offsets"][0] : base["offsets"][1]]
    creases = [(int(face[i]), int(face[(i + 1) % 4]), np.inf) for i in range(4)]
    p = base["points"][face]
    curve = (np.roll(p, 1, axis=0) + 4 * p + np.roll(p, -1, axis=0)) / 6
    creased = closed.subdivide(0, 2, limit=True, creases=creases)
    assert distance_to_nearest(curve, creased["points"]) < 1e-12
    faded = closed.subdivide(0, 2, limit=True, creases=np.array([(a, b, 1.5) for a, b, _ in creases], dtype=object))
    assert not np.allclose(faded["points"], creased["points"]) and not np.allclose(faded["points"], closed.subdivide(0, 2, limit=True)["points"])

    sheet = open_sheet.level("N0")
    once = np.flatnonzero(np.bincount(sheet["indices"]) == 1)  # points of one quad
    kept = open_sheet.subdivide(0, 2, limit=True, boundary="edges_and_corners")
    assert len(once) >= 4 and distance_to_nearest(sheet["points"][once], kept["points"]) < 1e-12
    assert distance_to_nearest(sheet["points"][once], open_sheet.subdivide(0, 2, limit=True)["points"]) > 1e-3


def test_an_adaptive_hierarchy_is_refined_uniformly(adaptive):
    top = depth(adaptive)
    mesh = adaptive.subdivide(0, top)
    base_quads = len(adaptive.level("N0")["offsets"]) - 1
    assert len(mesh["offsets"]) - 1 == base_quads * 4**top
    continued = adaptive.subdivide(top, top, limit=True)
    assert same_faces(mesh, continued) and np.isfinite(continued["points"]).all()


def test_a_loaded_hierarchy_gives_the_same(closed, tmp_path):
    path = tmp_path / "sphere.hmesh"
    closed.save(path)
    loaded = _native.load_hierarchy(path)
    for options in ({}, {"limit": True}):
        assert np.array_equal(closed.subdivide(0, 3, **options)["points"], loaded.subdivide(0, 3, **options)["points"])


def test_without_operations_there_is_nothing_to_choose(closed):
    everything = closed.subdivide(0, 2)["points"]
    for operations in (True, False, []):
        for where in ("stored", "carried", "harmonic"):
            assert np.array_equal(closed.subdivide(0, 2, operations, operation_vertices=where)["points"], everything)


@pytest.mark.parametrize(
    "arguments, options, said",
    [
        ((-1, 2), {}, "no level N-1"),
        ((99, 99), {}, "no level N99"),
        ((2, 1), {}, "from level 2 to level 1"),
        ((0, 99), {}, "level 99"),
        ((0, 1), {"operations": [True]}, "1 choices for 0 operations"),
        ((0, 1), {"operations": 1}, "operations must be"),
        ((0, 1), {"operations": "all"}, "operations must be"),
        ((0, 1), {"operations": [1, 0]}, "operations must be"),
        ((0, 1), {"creases": [(0, 10**9, 1)]}, "crease 0 names point 1000000000"),
        ((0, 1), {"creases": [(0, 0, 1)]}, "no edge"),
        ((0, 1), {"creases": [(-1, 0, 1)]}, "crease 0 names point -1"),
        ((0, 1), {"corners": [(0, 1), (10**9, 1)]}, "corner 1 names point"),
        ((0, 1), {"corners": [(0, -1)]}, "sharpness"),
        ((0, 1), {"corners": [(0, float("nan"))]}, "sharpness"),
        ((0, 1), {"boundary": "none"}, "boundary must be one of 'edges', 'edges_and_corners'"),
        ((0, 1), {"operation_vertices": ""}, "operation_vertices must be"),
        ((0, 1), {"points": [[0, 0, 0]]}, "1 points for a level"),
        ((0, 1), {"points": []}, "points"),
        ((0, 1), {"points": "here"}, "points"),
        ((0, 1), {"points": [[0, 0]]}, "shape"),
    ],
)
def test_what_cannot_be_used_is_named(closed, arguments, options, said):
    with pytest.raises(_native.InvalidInput, match=said):
        closed.subdivide(*arguments, **options)


def test_points_that_are_not_finite(closed):
    points = closed.level("N0")["points"].copy()
    points[3, 1] = np.nan
    with pytest.raises(_native.InvalidInput, match="position 3"):
        closed.subdivide(0, 1, points=points)


def test_more_than_can_be_held_is_refused(closed):
    with pytest.raises(_native.Unsupported, match="quads"):
        closed.subdivide(0, 20)
