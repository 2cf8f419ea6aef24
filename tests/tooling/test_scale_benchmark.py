# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark of scale: what it measures is a finer version of the same surface, and its table is complete."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
BENCHMARKS = ROOT / "tests/benchmarks"
sys.path.insert(0, str(BENCHMARKS))
from finer_meshes import finer  # noqa: E402

OCTAHEDRON = (
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]],
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
)
SQUARE = ([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
# Two triangles on one edge, and a third one.
FAN = ([[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, -1, 0]], [[0, 1, 2], [0, 1, 3], [0, 1, 4]])


def edges(triangles):
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)


@pytest.mark.parametrize("mesh", [OCTAHEDRON, SQUARE, FAN], ids=["octahedron", "square", "fan"])
def test_each_triangle_becomes_four_and_the_topology_stays(mesh):
    points, triangles = np.array(mesh[0], float), np.array(mesh[1])
    for seed in range(4):
        pairs, uses = edges(triangles)
        more_points, more = finer(points, triangles, seed)
        more_pairs, more_uses = edges(more)
        assert len(more) == 4 * len(triangles) and len(more_points) == len(points) + len(pairs) == more.max() + 1
        # Every edge is cut in two, and three more are in each triangle.
        assert len(more_pairs) == 2 * len(pairs) + 3 * len(triangles)
        for number in (1, 3):
            assert (more_uses == number).sum() == 2 * (uses == number).sum()
        assert len(more_points) - len(more_pairs) + len(more) == len(points) - len(pairs) + len(triangles)
        points, triangles = more_points, more


def test_orientation_stays_and_the_shape_becomes_a_rough_ball():
    points, triangles = np.array(OCTAHEDRON[0], float), np.array(OCTAHEDRON[1])
    for seed in range(4):
        points, triangles = finer(points, triangles, seed)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    assert np.einsum("ij,ij->i", np.cross(a, b), c).sum() > 0
    # An octahedron's Loop surface is no ball, but near one; the roughness does not go away as it is cut finer.
    radii = np.linalg.norm(points, axis=1)
    assert 0.3 < radii.min() and radii.max() < 0.8
    following = radii[edges(triangles)[0]]
    assert np.abs(following[:, 0] - following[:, 1]).mean() > 0.01 * np.linalg.norm(b - a, axis=1).mean()


def test_a_straight_boundary_stays_straight_but_for_the_roughness():
    points, triangles = np.array(SQUARE[0], float), np.array(SQUARE[1])
    for seed in range(3):
        points, triangles = finer(points, triangles, seed)
    assert points[:, :2].min() > -0.2 and points[:, :2].max() < 1.2 and np.abs(points[:, 2]).max() < 0.2


def test_it_is_the_same_every_time_and_another_for_another_seed():
    first, again, other = (finer(*OCTAHEDRON, seed)[0] for seed in (1, 1, 2))
    assert (first == again).all() and (first != other).any()


def test_the_table(tmp_path):
    """From end to end, on a small model."""
    model = tmp_path / "ball.off"
    points, triangles = OCTAHEDRON
    for seed in range(3):
        points, triangles = finer(points, triangles, seed)
    model.write_text(
        f"OFF\n{len(points)} {len(triangles)} 0\n" + "".join("%r %r %r\n" % tuple(map(float, point)) for point in points)
        + "".join("3 %d %d %d\n" % tuple(face) for face in triangles)
    )  # fmt: skip
    rows = tmp_path / "scale.csv"
    command = [sys.executable, BENCHMARKS / "scale_benchmark.py", model, "--vertices", "300", "--sizes", "2", "--output", rows, "--", "--levels", "1"]
    ended = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=300, env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})
    assert ended.returncode == 0, ended.stderr
    assert "us/(n log n)" in ended.stdout and "--vertices 300 --levels 1" in ended.stdout
    with open(rows, encoding="utf-8", newline="") as file:
        first, second = csv.DictReader(file)
    assert (int(first["vertices"]), int(second["vertices"])) == (258, 1026)
    for row in (first, second):
        assert 200 < int(row["made"]) <= 300 and 0 < float(row["l2"]) < 0.1 and float(row["memory_mib"]) > 1
        by_stage = [float(value) for key, value in row.items() if key.startswith("cpu_seconds.") and value]
        assert sum(by_stage) == pytest.approx(float(row["cpu_seconds"]), abs=1e-6) and len(by_stage) > 2
        n = int(row["vertices"])
        assert float(row["microseconds_by_n_log_n"]) == pytest.approx(1e6 * float(row["seconds"]) / (n * np.log(n)))


@pytest.mark.parametrize("arguments, said", [(["none.ply"], "there is no none.ply"), (["--sizes", "0"], "a size at least")])
def test_wrong_arguments(arguments, said):
    ended = subprocess.run([sys.executable, BENCHMARKS / "scale_benchmark.py", *arguments], capture_output=True, encoding="utf-8", timeout=60)
    assert ended.returncode == 2 and said in ended.stderr
