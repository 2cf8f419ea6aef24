# SPDX-License-Identifier: GPL-3.0-or-later
import os
from pathlib import Path

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, cube, mesh_of, sphere, torus


def test_version():
    assert [part.isdigit() for part in _native.__version__.split(".")] == [True] * 3


def test_every_error_is_an_error():
    for name in ["InvalidInput", "Unsupported", "Cancelled", "CorruptStream", "IoError", "InternalError"]:
        assert issubclass(getattr(_native, name), _native.Error)
    assert issubclass(_native.Error, Exception)


@pytest.mark.parametrize("suffix", [".ply", ".obj"])
@pytest.mark.parametrize("as_path", [str, Path, os.fsencode])
def test_a_written_mesh_is_read_again(tmp_path, suffix, as_path):
    path = tmp_path / f"Würfel{suffix}"
    _native.write_mesh(as_path(str(path)), *cube())
    points, offsets, indices = _native.read_mesh(as_path(str(path)))
    assert (points.dtype, offsets.dtype, indices.dtype) == (np.float64, np.int64, np.int32)
    assert os.listdir(tmp_path) == [path.name]
    topology = _native.topology(points, offsets, indices)
    assert (topology["vertices"], topology["euler"], topology["genus"]) == (8, 2, 0)
    assert np.allclose(points.min(axis=0), -1) and np.allclose(points.max(axis=0), 1)


def test_a_file_that_cannot_be_read_or_written(tmp_path):
    with pytest.raises(_native.IoError, match="absent"):
        _native.read_mesh(str(tmp_path / "absent.ply"))
    with pytest.raises(_native.IoError):
        _native.write_mesh(str(tmp_path / "no folder" / "cube.ply"), *cube())
    empty = tmp_path / "empty.ply"
    empty.write_bytes(b"")
    with pytest.raises(_native.Error):
        _native.read_mesh(str(empty))


@pytest.mark.parametrize("shape, genus, loops", [(sphere, 0, 0), (torus, 1, 0), (bent_sheet, 0, 1)])
def test_topology(shape, genus, loops):
    topology = _native.topology(*shape())
    assert (topology["genus"], topology["boundary_loops"], topology["components"]) == (genus, loops, 1)
    assert topology["vertices"] - topology["edges"] + topology["faces"] == topology["euler"]
    assert [topology[name] for name in ("nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges")] == [0, 0, 0]


def test_repair_leaves_a_clean_mesh_alone():
    points, offsets, indices, report = _native.repair(*torus())
    assert not report["changed"]
    assert (len(points), len(offsets) - 1) == (48 * 24, 2 * 48 * 24)


def test_repair_counts_what_it_changes():
    points, offsets, indices = sphere(4)
    faces = indices.reshape(-1, 3).tolist()
    faces[5].reverse()
    faces.append(faces[0])
    repaired = _native.repair(*mesh_of(np.vstack([points, [[9, 9, 9]]]), faces))
    report = repaired[3]
    assert report["changed"] and report["duplicate_faces"] == 1 and report["isolated_points"] == 1 and report["reoriented_faces"] >= 1
    topology = _native.topology(*repaired[:3])
    assert [topology[name] for name in ("nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges")] == [0, 0, 0]


def test_compare():
    mesh = torus()
    assert _native.compare(*mesh, *mesh, samples=5000)["hausdorff"] < 1e-12
    moved = (mesh[0] + [0, 0, 0.01], mesh[1], mesh[2])
    distance = _native.compare(*mesh, *moved, samples=20000)
    assert 0 < distance["l2"] <= distance["hausdorff"] <= 0.0101 / distance["diagonal"]
    assert distance["boundary_hausdorff"] == -1
    assert distance["diagonal"] == pytest.approx(np.linalg.norm(np.ptp(mesh[0], axis=0)))
    sheet = bent_sheet()
    assert _native.compare(*sheet, sheet[0] + [0, 0, 0.01], *sheet[1:])["boundary_hausdorff"] > 0


def bad_meshes():
    points, offsets, indices = cube()

    def replaced(array, place, value):
        array = array.copy()
        array[place] = value
        return array

    yield "no points", (np.zeros((0, 3)), [0], [])
    yield "no faces", (points, [0], np.zeros(0, np.int32))
    yield "shape", (points[:, :2], offsets, indices)
    yield "shape", (points.ravel(), offsets, indices)
    yield "numbers", (np.array([["a", "b", "c"]]), offsets, indices)
    yield "whole numbers", (points, offsets.astype(float), indices)
    yield "whole numbers", (points, offsets, indices.astype(float))
    yield "dimension", (points, offsets.reshape(1, -1), indices)
    yield "dimension", (points, offsets, indices.reshape(-1, 4))
    yield "begin with 0", (points, offsets + 1, indices)
    yield "decrease", (points, replaced(offsets, 2, 2), indices)
    yield "fewer than three", (points, replaced(offsets, 1, 2), indices)
    yield "end with", (points, offsets[:-1], indices)
    yield "face_indices", (points, offsets, replaced(indices, 7, 8))
    yield "face_indices", (points, offsets, replaced(indices, 7, -1))
    yield "not finite", (replaced(points, (3, 1), np.nan), offsets, indices)
    yield "not finite", (replaced(points, (3, 1), np.inf), offsets, indices)


@pytest.mark.parametrize("message, mesh", bad_meshes())
def test_arrays_that_are_no_mesh_are_refused(message, mesh):
    with pytest.raises(_native.InvalidInput, match=message):
        _native.topology(*mesh)


def test_arrays_of_other_types_and_layouts_are_converted():
    points, offsets, indices = cube()
    expected = _native.topology(points, offsets, indices)
    assert _native.topology(points.astype(np.float32), offsets.astype(np.int32), indices.astype(np.uint64)) == expected
    assert _native.topology(np.asfortranarray(points), np.repeat(offsets, 2)[::2], indices) == expected
    assert _native.topology(points.tolist(), offsets.tolist(), indices.tolist()) == expected
