# SPDX-License-Identifier: GPL-3.0-or-later
"""Wrecks cannot hide: what must come out poor is said to be poor, for the right reason and at the right place, by the command line."""

import csv
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import mesh_of, sphere

BUNNY = pathlib.Path(__file__).resolve().parents[2] / "blend_samples" / "bunny.ply"


def with_needle():
    """A ball with a needle 40 times as long as wide, out to x = 5; it stands far from the origin and is 10 times as large."""
    points, offsets, indices = sphere(40)
    off = ((points - [1, 0, 0]) ** 2).sum(axis=1)
    points = points + 4 * np.exp(-off / 0.05**2)[:, None] * np.array([1, 0, 0])
    return 10 * points + PLACE, offsets, indices


PLACE = np.array([300.0, -200.0, 70.0])


def with_fold():
    """A ball that is cut to near its middle by a slit much narrower than its quads, along z = 0 where x > 0."""
    points, offsets, indices = sphere(90)
    depth = 0.95 * np.exp(-((points[:, 2] / 0.015) ** 2)) * np.clip(points[:, 0], 0, 1)
    return points * (1 - depth)[:, None], offsets, indices


def jagged():
    """A disk with thorns around it, which a few hundred quads can follow, but not with good corners: between thorns it turns inwards."""
    thorns, each, rings = 40, 24, 8
    count = thorns * each
    place = np.arange(count) / each
    radius = 1 - 0.4 * np.abs(2 * (place % 1) - 1) ** 0.7
    angle = 2 * np.pi * place / thorns
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    k = np.arange(count)
    after = (k + 1) % count
    faces = [np.stack([0 * k, 1 + k, 1 + after], axis=1)]
    for first in 1 + count * np.arange(rings - 1):
        faces += [np.stack([first + k, first + count + k, first + count + after], axis=1), np.stack([first + k, first + count + after, first + after], axis=1)]
    return mesh_of(np.concatenate([np.zeros((1, 3)), *(rim * (ring + 1) / rings for ring in range(rings))]), np.concatenate(faces))


def shell(wall):
    """A hollow ball of radius 1."""
    points, _, indices = sphere(24)
    faces = indices.reshape(-1, 3)
    return mesh_of(np.concatenate([points, (1 - wall) * points]), [*faces, *(faces[:, ::-1] + len(points))])


class Outcome:
    def __init__(self, folder, mesh, *options):
        source = mesh if isinstance(mesh, pathlib.Path) else folder / "wreck.ply"
        if source is not mesh:
            _native.write_mesh(str(source), *mesh)
        self.command = ["remesh", str(source), "--output", str(folder / "out"), "--export", "ply", *map(str, options)]
        self.folder, self.name = folder / "out", source.stem
        run = self.run(*self.command)
        self.code, self.err, self.out = run.returncode, run.stderr, run.stdout
        self.report = json.loads((self.folder / f"{self.name}.report.json").read_text(encoding="utf-8"))
        self.reasons = {reason["what"]: reason for reason in self.report["verdict"]["reasons"]}

    def run(self, *arguments):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYTHONDONTWRITEBYTECODE": "1"}
        return subprocess.run([sys.executable, "-m", "hybrid_mesh", *arguments], env=environment, capture_output=True, text=True, timeout=300)

    def row(self):
        with open(self.folder / "summary.csv", encoding="utf-8", newline="") as file:
            return next(csv.DictReader(file))

    def final(self):
        return _native.read_mesh(str(self.folder / f"{self.name}.ply"))


def check_poor(outcome):
    """It is said everywhere alike, and is no failure."""
    texts = [reason["text"] for reason in outcome.reasons.values()]
    assert outcome.code == 0 and outcome.report["verdict"]["result"] == "poor" and texts
    assert [line for text in texts for line in outcome.err.splitlines() if f"poor: {text}" in line] == [line for line in outcome.err.splitlines() if "poor: " in line]
    assert outcome.out.splitlines()[-1].endswith("1 poor result")
    row = outcome.row()
    assert (row["status"], row["verdict"]) == ("done", "poor") and all(text in row["reasons"] for text in texts)
    info = json.loads(outcome.run("info", str(outcome.folder / f"{outcome.name}.hmesh")).stdout)
    assert info["verdict"] == outcome.report["verdict"]


def distance_to(mesh, place):
    """Of a point to the corners of a mesh."""
    return np.linalg.norm(mesh[0] - place, axis=1).min()


def test_a_lost_needle(tmp_path):
    outcome = Outcome(tmp_path, with_needle(), "--vertices", 300)
    check_poor(outcome)
    reason = outcome.reasons["hausdorff"]
    assert "is lost" in reason["text"]
    # Its tip, and nothing of the mesh is near.
    mesh = with_needle()
    assert np.allclose(reason["where"], mesh[0][mesh[0][:, 0].argmax()], atol=1e-3)
    diagonal = np.linalg.norm(np.ptp(mesh[0], axis=0))
    assert distance_to(outcome.final(), reason["where"]) >= 0.99 * outcome.report["final"]["hausdorff"] * diagonal


def test_a_closed_fold(tmp_path):
    outcome = Outcome(tmp_path, with_fold(), "--vertices", 500, "--base-quads", "min", "--levels", 3)
    check_poor(outcome)
    where = np.array(outcome.reasons["hausdorff"]["where"])
    # In the cut, or where the mesh goes down beside it: nowhere else is anything this deep in the ball. Which of these it is, near-ties decide.
    assert where[0] > 0 and np.linalg.norm(where) < 0.9 and "vertices" not in outcome.reasons
    # And it is as far away as that.
    mesh = with_fold()
    least = 0.99 * outcome.report["final"]["hausdorff"] * np.linalg.norm(np.ptp(mesh[0], axis=0))
    assert max(distance_to(mesh, where), distance_to(outcome.final(), where)) >= least


def test_inverted_quads(tmp_path):
    outcome = Outcome(tmp_path, jagged(), "--vertices", 700)
    check_poor(outcome)
    points, offsets, indices = outcome.final()
    corners = points[indices.reshape(-1, 4)]
    edges = np.roll(corners, -1, axis=1) - corners
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    before = -np.roll(edges, 1, axis=1)
    sizes = np.linalg.norm(edges, axis=2) * np.linalg.norm(before, axis=2) * np.linalg.norm(normals, axis=1)[:, None]
    worst = (np.einsum("fij,fj->fi", np.cross(edges, before), normals) / sizes).min(axis=1)
    # Straight corners, on one edge of the surface's boundary, are neither but for rounding.
    inverted = worst < 1e-9
    sure = int((worst < -1e-9).sum())
    assert sure > 20 and inverted.sum() < 1.3 * sure
    assert outcome.reasons["inverted"]["text"].startswith(tuple(f"{n} of {len(corners)} quads are inverted" for n in range(sure, inverted.sum() + 1)))
    middles = corners[inverted].mean(axis=1)
    assert np.linalg.norm(middles - outcome.reasons["inverted"]["where"], axis=1).min() < 1e-4


def test_walls_that_run_through_one_another(tmp_path):
    """Where the wall is far thinner than its quads bend."""
    outcome = Outcome(tmp_path, shell(0.0001), "--vertices", 1500)
    check_poor(outcome)
    assert set(outcome.reasons) == {"self_intersections"}
    reason = outcome.reasons["self_intersections"]
    count = outcome.report["final"]["self_intersections"]
    assert reason["text"].startswith(f"{count} pairs of faces") and 0.95 < np.linalg.norm(reason["where"]) < 1.01
    assert outcome.row()["self_intersections"] == str(count)


def test_thin_walls_are_kept_apart(tmp_path):
    """Quads that bend by more than half of the wall's width, and would cross it in places."""
    outcome = Outcome(tmp_path, shell(0.005), "--vertices", 1000)
    assert outcome.report["verdict"]["result"] == "good" and outcome.report["final"]["self_intersections"] == 0


def test_vertices_that_a_least_base_leaves(tmp_path):
    outcome = Outcome(tmp_path, sphere(), "--vertices", 5000, "--base-quads", "min", "--semi-regular")
    check_poor(outcome)
    assert set(outcome.reasons) == {"vertices"} and "where" not in outcome.reasons["vertices"]
    assert str(outcome.report["final"]["vertices"]) in outcome.reasons["vertices"]["text"]


def test_strict_makes_it_a_failure_with_files(tmp_path):
    outcome = Outcome(tmp_path, with_needle(), "--vertices", 300, "--strict")
    assert outcome.code == 1 and outcome.reasons
    row = outcome.row()
    assert row["status"] == "failed" and outcome.reasons["hausdorff"]["text"] in row["error"]
    assert (outcome.folder / "wreck.hmesh").is_file() and len(outcome.final()[0]) == int(row["vertices"])


@pytest.mark.parametrize("mesh, vertices", [(sphere(), 2000), (BUNNY, 8000)], ids=["sphere", "bunny"])
def test_good_ones_are_good(tmp_path, mesh, vertices):
    outcome = Outcome(tmp_path, mesh, "--vertices", vertices, "--strict")
    assert (outcome.code, outcome.err, outcome.report["verdict"]) == (0, "", {"result": "good", "reasons": []})
    assert outcome.row()["verdict"] == "good" and outcome.report["final"]["self_intersections"] == 0
