# SPDX-License-Identifier: GPL-3.0-or-later
import gltf_reader
import numpy
import pytest
from hybrid_mesh import _native as fake
from hybrid_mesh.core import gltf


def placed(content, node, points):
    """Points where their node puts them."""
    made = content["nodes"][node]
    x, y, z, w = made.get("rotation", (0, 0, 0, 1))
    turn = numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
    return points @ turn.T + made["translation"]


def area(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2


@pytest.fixture
def mesh():
    """A box of 1 x 2 x 3 far from the origin, of 24 quads, patches its sides."""
    return fake.box(numpy.array([1e5, 2e5, 3e5]), numpy.array([1e5 + 1, 2e5 + 2, 3e5 + 3]), 1)


def test_a_mesh_with_its_attributes(tmp_path, mesh):
    gltf.write(str(tmp_path / "a.glb"), [("a", mesh)])
    content, array = gltf_reader.read(tmp_path / "a.glb")
    attributes, triangles = gltf_reader.primitive(content, array, 0)
    assert content["scenes"] == [{"nodes": [0]}] and "extensionsUsed" not in content and len(triangles) == 48
    # Far from the origin 32 bits would not hold them.
    points = placed(content, 0, attributes["POSITION"].astype(float))
    assert numpy.abs(points.min(0) - [1e5, 2e5, 3e5]).max() < 1e-6 and numpy.abs(points.max(0) - [1e5 + 1, 2e5 + 2, 3e5 + 3]).max() < 1e-6
    assert area(points, triangles) == pytest.approx(22)
    middle = points.mean(0)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    assert (((numpy.cross(b - a, c - a)) * (a - middle)).sum(1) > 0).all()  # faces outwards
    assert set(attributes) == {"POSITION", "NORMAL", "TEXCOORD_0", "_PATCH", "_STRETCH", "_ANISOTROPY", "_IRREGULAR"}
    assert numpy.abs(numpy.linalg.norm(attributes["NORMAL"], axis=1) - 1).max() < 1e-6
    # A patch is whole: no triangle has vertices of two.
    assert (attributes["_PATCH"][triangles] == attributes["_PATCH"][triangles][:, :1]).all() and set(attributes["_PATCH"]) == set(range(6))
    for patch in range(6):
        inside = attributes["_PATCH"] == patch
        wanted = mesh["stretch"][mesh["patch"] == patch].mean()
        assert attributes["_STRETCH"][inside].min() >= mesh["stretch"][mesh["patch"] == patch].min() and attributes["_STRETCH"][inside].mean() == pytest.approx(wanted, rel=0.3)
    # From the top.
    assert {tuple(value) for value in attributes["TEXCOORD_0"]} == {(0, 1), (1, 1), (1, 0), (0, 0)}


def test_normals_are_shared_across_seams_but_not_across_sharp_edges(tmp_path, mesh):
    for sharp in (False, True):
        points = mesh["points"]
        if sharp:  # the box's edges: those on two of its sides
            ends = numpy.stack([points[mesh["indices"]], points[mesh["indices"].reshape(-1, 4)[:, [1, 2, 3, 0]].ravel()]])
            low, high = points.min(0), points.max(0)
            mesh["sharp"] = ((ends == low) | (ends == high)).all(0).sum(1) >= 2
        gltf.write(str(tmp_path / "a.glb"), [("a", mesh)])
        content, array = gltf_reader.read(tmp_path / "a.glb")
        attributes, triangles = gltf_reader.primitive(content, array, 0)
        corner = numpy.abs(placed(content, 0, attributes["POSITION"].astype(float)) - points.min(0)).max(1) < 1e-6
        normals = {tuple(numpy.round(normal, 5)) for normal in attributes["NORMAL"][corner]}
        assert corner.sum() >= 3 and len(normals) == (3 if sharp else 1)


def test_z_that_is_up_is_turned(tmp_path, mesh):
    gltf.write(str(tmp_path / "a.glb"), [("a", mesh)], z_up=True)
    content, array = gltf_reader.read(tmp_path / "a.glb")
    attributes, _ = gltf_reader.primitive(content, array, 0)
    points = placed(content, 0, attributes["POSITION"].astype(float))
    assert numpy.abs(points.max(0) - [1e5 + 1, 3e5 + 3, -2e5]).max() < 1e-6


def test_a_chain_of_levels(command_line):
    command = ("remesh", command_line.box("box.obj"), "--output", "out", "--levels", 2, "--export", "glb", "--export-levels", "glb,ply")
    assert command_line.run(*command).returncode == 0
    assert {"box.glb", "box.levels.glb", "box.N0.ply", "box.N2.ply"} < set(command_line.outputs()) and "box.N0.glb" not in command_line.outputs()
    content, array = gltf_reader.read(command_line.folder / "out/box.levels.glb")
    assert [node["name"] for node in content["nodes"]] == ["N0", "N1", "N2"] and content["scenes"] == [{"nodes": [2]}]
    assert content["nodes"][2]["extensions"]["MSFT_lod"] == {"ids": [1, 0]} and content["extensionsUsed"] == ["MSFT_lod"]
    coverage = content["nodes"][2]["extras"]["MSFT_screencoverage"]
    assert len(coverage) == 3 and coverage == sorted(coverage, reverse=True)
    assert [len(gltf_reader.primitive(content, array, node)[1]) for node in range(3)] == [12, 48, 192]
    assert "skipped" in command_line.run(*command, "--resume").out
    (command_line.folder / "out/box.levels.glb").unlink()
    assert "skipped" not in command_line.run(*command, "--resume").out
    again = (command_line.folder / "out/box.levels.glb").read_bytes()
    command_line.run(*command)
    assert (command_line.folder / "out/box.levels.glb").read_bytes() == again
