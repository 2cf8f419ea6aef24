# SPDX-License-Identifier: GPL-3.0-or-later
"""Quads that an attribute makes smaller or larger, from a file on the command line to the report."""

import json
import math

import numpy as np
import pytest
from hybrid_mesh import _native
from hybrid_mesh.core import cli
from shapes import cube, sphere

MET = math.log(1.25)


def write_ply(path, mesh, values, name="paint"):
    points, offsets, indices = mesh
    lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}", *(f"property double {axis}" for axis in "xyz"), f"property double {name}"]
    lines += [f"element face {len(offsets) - 1}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, (*point, value))) for point, value in zip(points.tolist(), values)]
    lines += [f"{end - begin} " + " ".join(map(str, indices[begin:end])) for begin, end in zip(offsets[:-1], offsets[1:])]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def painted():
    mesh = sphere(24)
    return mesh, 0.5 + 0.25 * mesh[0][:, 2]


def remesh(tmp_path, path, *options):
    """(exit code, report) of the command line."""
    code = cli.run(["remesh", path, "--output", str(tmp_path / "out"), *options])
    name = path.rsplit("/", 1)[-1].removesuffix(".ply").removesuffix(".obj")
    return code, json.loads((tmp_path / "out" / f"{name}.report.json").read_text())


def shares(path):
    """The part of a mesh's vertices in the lower and in the upper half."""
    z = _native.read_mesh(path)[0][:, 2]
    return (z < 0).mean(), (z > 0).mean()


def test_an_attribute_of_a_file(tmp_path):
    path = write_ply(tmp_path / "ball.ply", *painted())
    code, report = remesh(tmp_path, path, "--vertices", "2000", "--density", "paint", "--export", "ply")
    assert code == 0 and report["verdict"]["result"] == "good" and report["settings"]["density"] == "paint"
    density = report["density"]
    assert density["name"] == "paint" and density["met"] <= MET
    assert density["smallest"] == pytest.approx(0.5) and density["largest"] == pytest.approx(2)
    lower, upper = shares(str(tmp_path / "out" / "ball.ply"))
    assert upper > 2 * lower
    code, plain = remesh(tmp_path, path, "--vertices", "2000", "--export", "ply")
    assert code == 0 and "density" not in plain and "density" not in plain["settings"]
    lower, upper = shares(str(tmp_path / "out" / "ball.ply"))
    assert 0.9 < upper / lower < 1.1


def test_adaptive(tmp_path):
    path = write_ply(tmp_path / "ball.ply", *painted())
    code, report = remesh(tmp_path, path, "--vertices", "2000", "--adaptive", "--density", "paint", "--export", "ply")
    assert code == 0 and report["final"]["vertices"] <= 2000
    lower, upper = shares(str(tmp_path / "out" / "ball.ply"))
    assert upper > 1.5 * lower


def test_resume_knows_of_it(tmp_path, capfd):
    path = write_ply(tmp_path / "cube.ply", cube(), np.linspace(0.4, 0.6, 8))
    for options in ((), ("--density", "paint")):
        assert remesh(tmp_path, path, "--vertices", "500", "--resume", *options)[0] == 0
        assert "skipped" not in capfd.readouterr().out
    assert remesh(tmp_path, path, "--vertices", "500", "--resume", "--density", "paint")[0] == 0
    assert "skipped" in capfd.readouterr().out


@pytest.mark.parametrize("values, name, said", [
    (np.ones(8), "weight", "'weight'"),
    (np.array([1, 1, 1, math.nan, 1, 1, 1, 1]), "paint", "the density 'paint' is not a finite number at point 3"),
    (np.array([1, 1, 1, 1, 1, math.inf, 1, 1]), "paint", "the density 'paint' is not a finite number at point 5"),
])  # fmt: skip
def test_what_cannot_be_read_is_said_by_name(tmp_path, capfd, values, name, said):
    path = write_ply(tmp_path / "cube.ply", cube(), values)
    code, report = remesh(tmp_path, path, "--vertices", "500", "--density", name)
    assert code == 1 and said in report["error"] and said in capfd.readouterr().err
    assert not (tmp_path / "out" / "cube.hmesh").exists()


def test_other_formats_have_none(tmp_path, capfd):
    _native.write_mesh(tmp_path / "cube.obj", *cube())
    code, report = remesh(tmp_path, str(tmp_path / "cube.obj"), "--density", "paint")
    assert code == 1 and "'paint'" in report["error"] and "'paint'" in capfd.readouterr().err


def test_values_beyond_the_bounds_are_said(tmp_path, capfd):
    path = write_ply(tmp_path / "cube.ply", cube(), np.linspace(-1, 1, 8))
    code, report = remesh(tmp_path, path, "--vertices", "500", "--density", "paint")
    assert code == 0 and any("'paint'" in warning and "0 to 1" in warning for warning in report["warnings"])
    assert (report["density"]["smallest"], report["density"]["largest"]) == (0.25, 4)


def test_from_a_script():
    mesh, values = painted()
    report = json.loads(_native.remesh(*mesh, {"vertices": 1500, "density": "paint"}, values).report)
    assert report["density"]["met"] <= MET
    for wrong in (values[:-1], None):
        with pytest.raises(_native.InvalidInput, match="the density 'paint' has [0-9]+ values for [0-9]+ points"):
            _native.remesh(*mesh, {"vertices": 1500, "density": "paint"}, wrong)
    with pytest.raises(_native.InvalidInput, match="density must have one dimension"):
        _native.remesh(*mesh, {"vertices": 1500, "density": "paint"}, values[:, None])
    with pytest.raises(_native.InvalidInput, match="density must hold numbers"):
        _native.remesh(*mesh, {"vertices": 1500, "density": "paint"}, ["a"] * len(values))
    with pytest.raises(_native.InvalidInput, match="the setting density must be text"):
        _native.remesh(*mesh, {"density": 1})
