# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges of the input that stay edges: which corners of a mesh's faces are marked, and where the marked edges lie."""

import itertools

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, cube, mesh_of, sphere

CUBE_CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
CUBE_EDGES = [(a, b) for a, b in itertools.combinations(CUBE_CORNERS, 2) if (a != b).sum() == 1]
SETTINGS = [
    {"vertices": 2000},
    {"vertices": 2000, "features": 40},
    {"vertices": 1000, "base": "min"},
    {"vertices": 2000, "refinement": "adaptive"},
    {"vertices": 2000, "refinement": "adaptive", "faces": "transition"},
    {"vertices": 2000, "refinement": "adaptive", "faces": "triangles"},
]


def meshes_of(surface, settings):
    """The final mesh and that of every level."""
    result = _native.remesh(*surface, settings)
    return [result.final_mesh(), *(result.hierarchy.level(name) for name in result.hierarchy.level_names)]


def corner_edges(mesh):
    """The ends of the edge from each corner to its face's next."""
    following = np.arange(1, len(mesh["indices"]) + 1)
    following[mesh["offsets"][1:] - 1] = mesh["offsets"][:-1]
    return np.stack([mesh["indices"], mesh["indices"][following]], axis=1)


def sharp_edges(mesh):
    """The marked edges, each once, after a look at whether the faces on both sides of every edge say the same of it."""
    edges, number, count = np.unique(np.sort(corner_edges(mesh), axis=1), axis=0, return_inverse=True, return_counts=True)
    marks = np.bincount(number.ravel(), weights=mesh["sharp"])
    assert set(count) == {2} and set(marks) <= {0, 2}
    return edges[marks > 0]


def check_covered(mesh, lines):
    """Whether the sharp edges of a mesh are pieces of these lines, all of each, and nothing else."""
    edges = mesh["points"][sharp_edges(mesh)]
    found = 0
    for a, b in lines:
        along = (b - a) / np.linalg.norm(b - a)
        places = (edges - a) @ along
        away = np.linalg.norm(edges - a - places[..., None] * along, axis=2)
        on_it = (away < 1e-12).all(axis=1) & (places > -1e-12).all(axis=1) & (places < np.linalg.norm(b - a) + 1e-12).all(axis=1)
        assert np.ptp(places[on_it], axis=1).sum() == pytest.approx(np.linalg.norm(b - a), rel=1e-9)
        found += on_it.sum()
    assert found == len(edges)


@pytest.mark.parametrize("settings", SETTINGS)
def test_the_edges_of_a_cube(settings):
    for mesh in meshes_of(cube(), settings):
        assert mesh["sharp"].dtype == np.bool_ and mesh["sharp"].shape == mesh["indices"].shape
        check_covered(mesh, CUBE_EDGES)
        assert max(np.abs(mesh["points"] - corner).max(axis=1).min() for corner in CUBE_CORNERS) < 1e-12


@pytest.mark.parametrize(
    "surface, settings",
    [(sphere(), {}), (sphere(5), {}), (bent_sheet(), {}), (cube(), {"features": "none"}), (cube(), {"features": 100})],
    ids=["sphere", "coarse sphere", "sheet", "cube without", "cube below the angle"],
)
def test_where_there_are_none(surface, settings):
    for mesh in meshes_of(surface, {"vertices": 1500, **settings}):
        assert "sharp" not in mesh


def prism():
    """Six sides, at which it turns by 60 degrees, and two ends, at which it turns by 90."""
    angles = np.arange(6) * np.pi / 3
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points = np.concatenate([np.column_stack([ring, np.full(6, z)]) for z in (-1.0, 1.0)])
    sides = [[i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6)]
    return points, mesh_of(points, [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], *sides])


@pytest.mark.parametrize("features, sides", [("auto", True), (50, True), (70, False)])
def test_the_angle_decides(features, sides):
    points, surface = prism()
    ends = [(points[k + i], points[k + (i + 1) % 6]) for k in (0, 6) for i in range(6)]
    for mesh in meshes_of(surface, {"vertices": 2000, "features": features}):
        check_covered(mesh, ends + [(points[i], points[6 + i]) for i in range(6)] * sides)


def test_a_saved_hierarchy_keeps_them(tmp_path):
    hierarchy = _native.remesh(*cube(), {"vertices": 1000, "refinement": "adaptive"}).hierarchy
    hierarchy.save(tmp_path / "cube.hmesh")
    loaded = _native.load_hierarchy(tmp_path / "cube.hmesh")
    assert loaded.check() == []
    for name in hierarchy.level_names:
        assert hierarchy.level(name)["sharp"].any() and np.array_equal(hierarchy.level(name)["sharp"], loaded.level(name)["sharp"])
    assert np.array_equal(hierarchy.final_mesh()["sharp"], loaded.final_mesh()["sharp"])
