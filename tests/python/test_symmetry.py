# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes that are their own mirror images: as a module, and on the command line."""

import json

import numpy as np
import pytest
from hybrid_mesh import _native
from hybrid_mesh.core import cli
from shapes import sphere, torus


def dented_sphere(asymmetry=0.0):
    """Symmetric across x but for a bump at negative x; its triangles are in no way."""
    points, offsets, faces = sphere(20)
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    points = points @ turn.T
    x, y, z = points.T
    bump = asymmetry * np.exp(-((x + 0.8) ** 2 + (y - 0.6) ** 2 + z**2) / 0.1)
    return points * (1 + 0.15 * np.cos(4 * x) * np.sin(2 * y) + 0.1 * np.sin(3 * z + 1) * y + bump)[:, None], offsets, faces


def levels_of(result):
    return [result.final_mesh(), *(result.hierarchy.level(name) for name in result.hierarchy.level_names)]


def check_mirrored(mesh, axis=0):
    """Whether every vertex and face has its mirror image exactly, and no edge in the plane is open."""
    points = mesh["points"] + 0.0
    index = {tuple(point): number for number, point in enumerate(points)}
    assert len(index) == len(points)
    mirrored = points.copy()
    mirrored[:, axis] = 0.0 - mirrored[:, axis]
    image = np.array([index[tuple(point)] for point in mirrored])
    corners = np.split(mesh["indices"], mesh["offsets"][1:-1])
    faces = {frozenset(face) for face in corners}
    assert {frozenset(image[face]) for face in corners} == faces and len(faces) == len(corners)
    edges = np.sort(np.concatenate([np.stack([face, np.roll(face, -1)], axis=1) for face in corners]), axis=1)
    edges, count = np.unique(edges, axis=0, return_counts=True)
    in_plane = (points[edges, axis] == 0).all(axis=1)
    assert in_plane.any() and (count[in_plane] == 2).all()


@pytest.mark.parametrize("refinement", ["uniform", "adaptive"])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_every_level_is_symmetric(refinement, axis):
    result = _native.remesh(*torus(), {"vertices": 1500, "refinement": refinement, "symmetry": "xyz"[axis]})
    for mesh in levels_of(result):
        check_mirrored(mesh, axis)
    report = json.loads(result.report)
    assert report["symmetry"]["plane"] == [float(axis == i) for i in range(3)] + [0.0]
    assert report["symmetry"]["from"] == "xyz"[axis]
    assert 1400 < report["final"]["vertices"] <= 1500


def test_a_plane_anywhere():
    points, offsets, faces = torus()
    normal = np.array([1.0, 2.0, -2.0]) / 3
    turn = np.linalg.qr(np.stack([normal, [0, 1, 0], [0, 0, 1]], axis=1))[0]
    turn[:, 0] = normal
    moved = points @ np.linalg.qr(turn)[0].T + [5, 6, 7]
    given = [1, 2, -2, 3 * (normal @ [5, 6, 7])]
    result = _native.remesh(moved, offsets, faces, {"vertices": 1000, "symmetry": given})
    for mesh in levels_of(result):
        heights = mesh["points"] @ normal - normal @ [5, 6, 7]
        mirrored = mesh["points"] - 2 * heights[:, None] * normal
        distance = np.linalg.norm(mirrored[:, None] - mesh["points"][None], axis=2)
        assert (distance.min(axis=1) < 1e-13 * 10).all()
        assert len(set(distance.argmin(axis=1))) == len(mirrored)
        assert (np.abs(heights) < 1e-13).sum() >= 8


def test_sides():
    surface = dented_sphere(0.12)
    reach = {}
    for side in ("positive", "negative", "average"):
        result = _native.remesh(*surface, {"vertices": 1000, "symmetry": "x", "symmetry_side": side})
        for mesh in levels_of(result):
            check_mirrored(mesh)
        points = result.final_mesh()["points"]
        near = points @ [-0.8, 0.6, 0] > 0.98 * np.linalg.norm(points, axis=1)
        reach[side] = np.linalg.norm(points[near], axis=1).max()
    assert reach["negative"] - reach["positive"] > 0.06
    assert reach["average"] == pytest.approx((reach["negative"] + reach["positive"]) / 2, abs=0.02)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"symmetry": "w"}, "symmetry must be"),
        ({"symmetry": [0, 0, 0, 1]}, "symmetry must be"),
        ({"symmetry": [1, 0, float("nan"), 0]}, "symmetry must be"),
        ({"symmetry": [1, 0, 0]}, "symmetry must be"),
        ({"symmetry": 1}, "symmetry must be"),
        ({"symmetry_side": "left"}, "symmetry_side must be"),
        ({"symmetry": "x", "topology": "late"}, "late topology"),
        ({"symmetry": "x", "components": "joined"}, "joined components"),
        ({"symmetry": [0, 0, 1, 5]}, "wholly on one side"),
    ],
)
def test_what_is_refused(settings, words):
    with pytest.raises(_native.InvalidInput, match=words):
        _native.remesh(*sphere(8), {"vertices": 500, **settings})


def test_command_line(tmp_path):
    points, offsets, faces = dented_sphere()
    source = tmp_path / "dented.ply"
    _native.write_mesh(str(source), points, offsets, faces)
    base = ["remesh", str(source), "--vertices", "800", "--export", "ply", "--output"]
    assert cli.run([*base, str(tmp_path / "plain")]) == 0
    assert cli.run([*base, str(tmp_path / "none"), "--symmetry", "none", "--symmetry-side", "negative"]) == 0
    assert cli.run([*base, str(tmp_path / "x"), "--symmetry", "x", "--export-levels", "ply"]) == 0
    assert cli.run([*base, str(tmp_path / "auto"), "--symmetry", "auto"]) == 0
    assert cli.run([*base, str(tmp_path / "beside"), "--symmetry", "1,0,0,9"]) == 1
    assert (tmp_path / "plain/dented.hmesh").read_bytes() == (tmp_path / "none/dented.hmesh").read_bytes()
    for path in [tmp_path / "x/dented.ply", tmp_path / "auto/dented.ply", *(tmp_path / "x").glob("dented.N*.ply")]:
        made = _native.read_mesh(str(path))
        check_mirrored(dict(zip(("points", "offsets", "indices"), made)))
    plain, x, auto, beside = (json.loads((tmp_path / name / "dented.report.json").read_text()) for name in ("plain", "x", "auto", "beside"))
    assert "symmetry" not in plain and "symmetry" not in plain["settings"]
    assert x["settings"]["symmetry"] == "x" and x["symmetry"]["from"] == "x" and auto["symmetry"]["from"] == "auto"
    assert x["symmetry"]["asymmetry"] < 1e-3
    assert "wholly on one side" in beside["error"]
    assert cli.run(["info", "--check", str(tmp_path / "x/dented.hmesh")]) == 0
