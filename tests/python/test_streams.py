# SPDX-License-Identifier: GPL-3.0-or-later
"""Hierarchies as embedded streams, saved and loaded by a script."""

import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import torus


def distance(a, b):
    return _native.compare(*(mesh[key] for mesh in (a, b) for key in ("points", "offsets", "indices")), 20000)["l2"]


def test_all_of_it_is_the_hierarchy(hierarchy, tmp_path):
    size = hierarchy.save_stream(tmp_path / "a.hmesh", exact=True)
    assert (tmp_path / "a.hmesh").stat().st_size == size
    loaded = _native.load_hierarchy(tmp_path / "a.hmesh")
    assert loaded.check() == [] and loaded.level_names == hierarchy.level_names
    for name in hierarchy.level_names:
        before, after = hierarchy.level(name), loaded.level(name)
        assert len(before["points"]) == len(after["points"]) and len(before["indices"]) == len(after["indices"])
    assert distance(hierarchy.final_mesh(), loaded.final_mesh()) < 1e-6
    # The same points in another order.
    before, after = (mesh.final_mesh()["points"] for mesh in (hierarchy, loaded))
    nearest = np.array([np.linalg.norm(after - point, axis=1).argmin() for point in before])
    assert len(set(nearest)) == len(before) and np.abs(before - after[nearest]).max() < 2e-4


def test_more_of_it_is_nearer(hierarchy, tmp_path):
    size = hierarchy.save_stream(tmp_path / "a.hmesh", exact=True)
    final = hierarchy.final_mesh()
    errors = [distance(final, _native.load_hierarchy(tmp_path / "a.hmesh", most_bytes=size // part).final_mesh()) for part in (16, 8, 4, 2, 1)]
    assert errors == sorted(errors, reverse=True) and errors[0] > 10 * errors[-1]


def test_a_fitted_stream_is_as_near_with_fewer_bytes(tmp_path):
    scan = torus()
    hierarchy = _native.remesh(*scan, {"vertices": 2000}).hierarchy
    sizes = {}
    for exact in (True, False):
        sizes[exact] = hierarchy.save_stream(tmp_path / "a.hmesh", error=5e-4, exact=exact, surface=scan)
        final = _native.load_hierarchy(tmp_path / "a.hmesh").final_mesh()
        assert _native.compare(*scan, final["points"], final["offsets"], final["indices"])["l2"] < 5.5e-4
    assert sizes[False] < 0.9 * sizes[True]


def test_bounds(hierarchy, tmp_path):
    size = hierarchy.save_stream(tmp_path / "a.hmesh", exact=True)
    assert hierarchy.save_stream(tmp_path / "b.hmesh", exact=True, most_bytes=size // 2) == size // 2
    assert (tmp_path / "b.hmesh").read_bytes() == (tmp_path / "a.hmesh").read_bytes()[: size // 2]
    short = hierarchy.save_stream(tmp_path / "c.hmesh", exact=True, error=1e-3)
    assert short < size and distance(hierarchy.final_mesh(), _native.load_hierarchy(tmp_path / "c.hmesh").final_mesh()) < 1.05e-3
    with pytest.raises(_native.InvalidInput, match="base alone"):
        hierarchy.save_stream(tmp_path / "d.hmesh", exact=True, most_bytes=10)
    with pytest.raises(_native.InvalidInput, match="error"):
        hierarchy.save_stream(tmp_path / "d.hmesh", exact=True, error=-1)
    assert not (tmp_path / "d.hmesh").exists()


def test_what_is_no_stream(hierarchy, tmp_path):
    hierarchy.save(tmp_path / "a.hmesh")
    with pytest.raises(_native.InvalidInput, match="a.hmesh"):
        _native.load_hierarchy(tmp_path / "a.hmesh", most_bytes=1000)
    hierarchy.save_stream(tmp_path / "b.hmesh")
    with pytest.raises(_native.CorruptStream, match="ends before its base"):
        _native.load_hierarchy(tmp_path / "b.hmesh", most_bytes=10)
    content = bytearray((tmp_path / "b.hmesh").read_bytes())
    content[3] = 9
    (tmp_path / "b.hmesh").write_bytes(content)
    with pytest.raises(_native.Unsupported, match="newer"):
        _native.load_hierarchy(tmp_path / "b.hmesh")
