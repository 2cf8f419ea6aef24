# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark of sharp edges: what it says of small shapes is what is known of them, and a tool that makes no mesh has a row."""

import csv
import sys
import time
from pathlib import Path

import numpy as np
import pytest

BENCHMARKS = Path(__file__).resolve().parents[2] / "tests/benchmarks"
sys.path.insert(0, str(BENCHMARKS))
import sharp_benchmark  # noqa: E402
import sharp_edges  # noqa: E402
import tools  # noqa: E402

DIAGONAL = np.sqrt(3)  # of a unit cube


def mesh_of(points, faces):
    sizes = [len(face) for face in faces]
    return np.array(points, float), np.concatenate([[0], np.cumsum(sizes)]), np.concatenate(faces).astype(np.int32)


def prism(outline):
    """Of a convex outline counter-clockwise, one unit high, of n-gons and quads."""
    count = len(outline)
    sides = [[k, (k + 1) % count, (k + 1) % count + count, k + count] for k in range(count)]
    faces = [list(reversed(range(count))), list(range(count, 2 * count)), *sides]
    return mesh_of([[x, y, z] for z in (0, 1) for x, y in outline], faces)


def cube():
    return prism([(0, 0), (1, 0), (1, 1), (0, 1)])


def chamfered(size):
    """A cube of which one edge is cut off."""
    return prism([(0, 0), (1, 0), (1, 1 - size), (1 - size, 1), (0, 1)])


def fine_cube(count, radius=0.0):
    """A cube of count^2 quads a side, which balls of a radius would roll along."""
    steps, numbers, points, faces = np.linspace(0, 1, count + 1), {}, [], []

    def number(point):
        if point not in numbers:
            numbers[point] = len(points)
            inner = np.clip(point, radius, 1 - radius)
            away = np.array(point) - inner
            points.append(inner + (radius * away / np.linalg.norm(away) if away.any() else 0))
        return numbers[point]

    for axis in range(3):
        for side in (0.0, 1.0):
            for i in range(count):
                for j in range(count):
                    corners = [np.roll([side, steps[i + a], steps[j + b]], axis) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                    face = [number(tuple(corner)) for corner in corners]
                    faces.append(face if side else face[::-1])
    return mesh_of(points, faces)


def triangulated(mesh):
    points, offsets, indices = mesh
    polygons = [indices[a:b] for a, b in zip(offsets[:-1], offsets[1:])]
    return mesh_of(points, [[face[0], face[k], face[k + 1]] for face in polygons for k in range(1, len(face) - 1)])


def moved(mesh):
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    turn[0] *= np.sign(np.linalg.det(turn))
    return 7.5 * mesh[0] @ turn.T + [3, -2, 5], mesh[1], mesh[2]


@pytest.mark.parametrize("other", [cube(), triangulated(cube()), fine_cube(4), fine_cube(7)], ids=["itself", "triangles", "4", "7"])
def test_a_cube_is_as_sharp_as_itself(other):
    figures = sharp_edges.measure(triangulated(cube()), other)
    assert (figures["missing"], figures["false"], figures["missing_mean"], figures["false_mean"]) == pytest.approx((0, 0, 0, 0), abs=1e-12)
    assert (figures["corners_kept"], figures["corners"]) == (8, 8)
    assert figures["angle_error"] == pytest.approx(0, abs=1e-6)


def test_the_sharp_edges_of_a_cube():
    curves = sharp_edges.sharp_edges(triangulated(cube()))
    assert len(curves.edges) == 12 and curves.angles == pytest.approx(90)
    assert len(sharp_edges.corners(curves)) == 8
    fine = sharp_edges.sharp_edges(fine_cube(5))
    assert len(fine.edges) == 12 * 5 and len(sharp_edges.corners(fine)) == 8


def test_a_rounded_cube_has_lost_all_edges():
    figures = sharp_edges.measure(triangulated(cube()), fine_cube(40, 0.2))
    assert figures["missing"] == np.inf and figures["false"] == 0
    assert figures["angle_error"] == pytest.approx(90)
    assert (figures["corners_kept"], figures["corners"]) == (0, 8)


def test_edges_that_are_not_where_they_were():
    """A cube of coarse quads, whose rounded edges still bend sharply: twice, and elsewhere."""
    figures = sharp_edges.measure(triangulated(cube()), fine_cube(10, 0.1))
    assert 0 < figures["missing"] < 0.15 and 0 < figures["false"] < 0.15 and figures["corners_kept"] == 0
    assert 30 < figures["angle_error"] < 60
    # What a corner of the cube is away from the ball in it.
    assert figures["corner_distance"] == pytest.approx(0.1 * (DIAGONAL - 1) / DIAGONAL)


@pytest.mark.parametrize("size", [0.05, 0.2])
def test_a_missing_edge_is_found(size):
    figures = sharp_edges.measure(triangulated(cube()), chamfered(size))
    # Halfway up the edge that is cut off the nearest sharp edge is that of the cut, and the other way.
    assert figures["missing"] == pytest.approx(size / DIAGONAL, rel=1e-9)
    assert figures["false"] == pytest.approx(size / DIAGONAL, rel=1e-9)
    assert 0 < figures["missing_mean"] < figures["missing"] / 8  # one edge of twelve
    assert (figures["corners_kept"], figures["corners"], figures["corner_distance"]) == (6, 8, 0)
    assert figures["angle_error"] == pytest.approx(0, abs=1e-6)
    # The other way it is the original that has the cut.
    back = sharp_edges.measure(triangulated(chamfered(size)), cube())
    assert back["missing"] * sharp_edges.diagonal(chamfered(size)) == pytest.approx(size) and back["corners_kept"] == 6


def test_the_pieces_that_are_lost_are_those_of_the_missing_edge():
    pieces = sharp_edges.lost_pieces(sharp_edges.sharp_edges(cube()), sharp_edges.sharp_edges(chamfered(0.2)), DIAGONAL)
    assert len(pieces) and (pieces[:, :, :2].max(axis=2) > 0.99).all()
    upright = np.abs(pieces[:, 1, 2] - pieces[:, 0, 2])
    assert upright.sum() == pytest.approx(1, abs=0.05)


def test_a_fold_is_a_false_edge():
    bump = fine_cube(8)
    at = np.flatnonzero((np.abs(bump[0] - [0.5, 0.5, 1]) < 1e-9).all(axis=1))
    assert len(at) == 1
    bump[0][at] += [0, 0, 0.2]
    figures = sharp_edges.measure(triangulated(cube()), bump)
    # The far end of what it bends is in the middle of a side, half a unit from the sharp edges, and above it.
    assert figures["missing"] == pytest.approx(0, abs=1e-12)
    assert 0.5 <= figures["false"] * DIAGONAL < 0.6


def test_a_boundary_that_is_closed_is_no_false_edge():
    points, offsets, indices = cube()
    box = points, offsets[1:] - 4, indices[4:]  # without a lid: eight sharp edges, four of which end at its rim
    curves = sharp_edges.sharp_edges(box)
    assert (len(curves.edges), len(curves.boundary), len(sharp_edges.corners(curves))) == (8, 4, 8)
    figures = sharp_edges.measure(triangulated(box), cube())
    assert (figures["missing"], figures["false"], figures["corners_kept"]) == (0, 0, 8)
    # A seam that opens is lost.
    torn = sharp_edges.measure(triangulated(cube()), box)
    assert torn["missing"] == pytest.approx(0.5 / DIAGONAL) and torn["false"] == 0


def test_orientation_does_not_matter():
    points, offsets, indices = triangulated(cube())
    turned = indices.copy()
    for face in (0, 3, 4, 9):
        turned[3 * face : 3 * face + 3] = turned[3 * face : 3 * face + 3][::-1]
    assert len(sharp_edges.sharp_edges((points, offsets, turned)).edges) == 12


@pytest.mark.parametrize("height", [0.0, 1e-9, -1e-9])
def test_a_needle_hides_no_edge_and_makes_none(height):
    """A triangle of no height, whatever its normal, on an edge of the cube."""
    points, offsets, indices = triangulated(cube())
    faces = [list(face) for face in indices.reshape(-1, 3)]
    sharp = next((face, k) for face in faces for k in range(3) if {face[k], face[(k + 1) % 3]} == {0, 1})
    a, b = sharp[0][sharp[1]], sharp[0][(sharp[1] + 1) % 3]
    beyond = next(face for face in faces if (a in face and b in face) and face is not sharp[0])
    apex = next(vertex for vertex in beyond if vertex not in (a, b))
    faces.remove(beyond)
    middle = len(points)
    faces += [[b, a, middle], [middle, a, apex], [b, middle, apex]]
    mesh = mesh_of([*points, (points[a] + points[b]) / 2 + [0, height, height]], faces)
    assert (np.sort(sharp_edges.edges_of(mesh)[1], axis=None) == np.arange(3 * len(faces))).all()
    curves = sharp_edges.sharp_edges(mesh)
    assert sharp_edges.one_way(curves, sharp_edges.sharp_edges(cube()), 0.01)[0] < 1e-8
    assert sharp_edges.one_way(sharp_edges.sharp_edges(cube()), curves, 0.01)[0] < 1e-8
    assert curves.angles == pytest.approx(90)


def test_a_ball_has_no_sharp_edges():
    ball = fine_cube(20, 0.5)
    figures = sharp_edges.measure(triangulated(ball), ball)
    assert (figures["missing"], figures["false"], figures["corners"], figures["angle_error"]) == (0, 0, 0, None)


def test_figures_do_not_depend_on_place_and_size():
    here = sharp_edges.measure(triangulated(cube()), chamfered(0.1))
    there = sharp_edges.measure(moved(triangulated(cube())), moved(chamfered(0.1)))
    for key in ("missing", "missing_mean", "false", "false_mean"):  # fractions of the bounding box, which a turn changes
        scale = sharp_edges.diagonal(moved(cube())) / 7.5 / DIAGONAL
        assert there[key] * scale == pytest.approx(here[key], rel=0.02)
    assert there["corners_kept"] == 6


def test_the_nearest_edge_is_the_nearest_of_all():
    rng = np.random.default_rng(3)
    points = rng.normal(size=(300, 3))
    curves = sharp_edges.Curves(points, np.stack([np.arange(299), np.arange(1, 300)], axis=1), np.zeros(299), np.empty((0, 2), int))
    asked = rng.normal(size=(500, 3))
    distances, edges = sharp_edges.nearest(asked, curves)
    a, b = points[:-1], points[1:]
    share = np.clip(np.einsum("ijk,jk->ij", asked[:, None] - a, b - a) / np.einsum("jk,jk->j", b - a, b - a), 0, 1)
    every = np.linalg.norm(asked[:, None] - a - share[:, :, None] * (b - a), axis=2)
    assert distances == pytest.approx(every.min(axis=1)) and (edges == every.argmin(axis=1)).all()


@pytest.mark.parametrize(
    "code, said",
    [
        ("import os; os.abort()", "exit code -6"), ("raise ValueError('an error of its own')", "an error of its own"),
        ("import time; time.sleep(60)", "not done after 1 s"),
    ],
    ids=["crash", "error", "hang"],
)  # fmt: skip
def test_a_tool_that_fails_says_why(code, said):
    mesh = triangulated(cube())
    model = tools.Model("cube", Path("cube.ply"), mesh, mesh, 2, 0)
    start = time.monotonic()
    with pytest.raises(tools.Failure, match=said):
        tools.through_arrays(model, [sys.executable, "-c", code], 100, timeout_s=1)
    assert time.monotonic() - start < 50


def test_what_a_tool_has_started_ends_with_it(tmp_path):
    ours = tmp_path / "pid"
    child = f"import os, time; open({str(ours)!r}, 'w').write(str(os.getpid())); time.sleep(60)"
    with pytest.raises(tools.Failure, match="not done"):
        tools.run([sys.executable, "-c", f"import subprocess, sys; subprocess.run([sys.executable, '-c', {child!r}])"], timeout_s=3)
    status = Path("/proc") / ours.read_text() / "stat"
    for _ in range(100):
        if not status.exists() or status.read_text().rsplit(")", 1)[1].split()[0] == "Z":
            return
        time.sleep(0.05)
    pytest.fail("it still runs")


def fails(model, vertices, **settings):
    raise tools.Failure("it cannot")


def makes_nothing_of_use(model, vertices, **settings):
    points, offsets, indices = model.triangles
    return tools.Outcome((np.full_like(points, np.nan), offsets, indices), 1.0, 1, 1.0)


def test_the_table(tmp_path, monkeypatch, capsys):
    """From end to end, with tools that fail beside ours."""
    monkeypatch.setattr(tools, "VERSUS", {"quadriflow": fails, "instant-meshes": makes_nothing_of_use})
    monkeypatch.setattr(sharp_benchmark, "CUBE", tmp_path / "cube.ply")
    rows = tmp_path / "sharp.csv"
    assert sharp_benchmark.main([str(tmp_path), "--vertices", "600", "--output", str(rows)]) == 0
    said = capsys.readouterr().out
    assert "FAILED: it cannot" in said and "FAILED: made points that are no numbers" in said and "8/8" in said
    with open(rows, encoding="utf-8", newline="") as file:
        ours, quadriflow, instant_meshes = csv.DictReader(file)
    assert 500 < int(ours["vertices"]) <= 600 and (ours["valid"], ours["pieces"], ours["corners_kept"]) == ("yes", "1", "8")
    assert float(ours["missing"]) < 1e-6 and float(ours["false"]) < 1e-6 and float(ours["angle_error"]) < 1e-3 and float(ours["cpu_seconds"]) > 0
    assert quadriflow["failure"] == "it cannot" and instant_meshes["tool"] == "instant-meshes"


def test_a_file_that_cannot_be_read_has_a_row(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sharp_benchmark, "CUBE", tmp_path / "cube.ply")
    (tmp_path / "broken.off").write_text("OFF\n3 1 0\n0 0\n")
    assert sharp_benchmark.main([str(tmp_path), "--vertices", "600", "--versus", "", "--output", str(tmp_path / "rows.csv")]) == 1
    said = capsys.readouterr().out
    assert "FAILED: cannot be read" in said and "8/8" in said


@pytest.mark.parametrize(
    "arguments, said",
    [(["--versus", "none"], "--versus knows"), (["--models", "none"], "has no none"), (["nowhere"], "there is no folder nowhere")],
)
def test_wrong_arguments(tmp_path, monkeypatch, capsys, arguments, said):
    monkeypatch.setattr(sharp_benchmark, "CUBE", tmp_path / "cube.ply")
    with pytest.raises(SystemExit) as ended:
        sharp_benchmark.main([*([] if "nowhere" in arguments else [str(tmp_path)]), *arguments])
    assert ended.value.code == 2 and said in capsys.readouterr().err
