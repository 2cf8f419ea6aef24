# SPDX-License-Identifier: GPL-3.0-or-later
import json
import subprocess
import sys
import time

import implicit_shapes
import numpy as np
import pytest
from hybrid_mesh import _native
from shapes import bent_sheet, cube, sphere, torus

SETTINGS = {"vertices": 3000}


@pytest.fixture(scope="module")
def result():
    return _native.remesh(*torus(), {"vertices": 3000})


def check_mesh(mesh):
    """Shapes and types of a dict of arrays. A hierarchy that a remesh has made also knows what opened where, and which edges are sharp."""
    points, faces, corners = len(mesh["points"]), len(mesh["offsets"]) - 1, len(mesh["indices"])
    expected = {
        "points": (np.float64, (points, 3)),
        "offsets": (np.int64, (faces + 1,)),
        "indices": (np.int32, (corners,)),
        "stretch": (np.float32, (faces,)),
        "anisotropy": (np.float32, (faces,)),
        "quad": (np.int32, (faces,)),
        "patch": (np.int32, (faces,)),
        "root": (np.int32, (faces,)),
        "path": (np.int32, (faces,)),
        "irregular": (np.bool_, (faces,)),
        "uv": (np.float32, (corners, 2)),
        "source_face": (np.int32, (points,)),
        "source_weights": (np.float32, (points, 3)),
    }
    if "opened" in mesh:
        expected |= {"opened": (np.int32, (faces,)), "opened_level": (np.int32, (faces,))}
    if "sharp" in mesh:
        expected |= {"sharp": (np.bool_, (corners,))}
    assert {name: (array.dtype, array.shape) for name, array in mesh.items()} == expected
    assert mesh["offsets"][-1] == corners and np.isfinite(mesh["points"]).all()


def check_uv(mesh):
    """Every face is an island's counter-clockwise part, of an area that is its share of the island."""
    assert (mesh["uv"] > 0).all() and (mesh["uv"] < 1).all()
    cells = {}
    for f in range(len(mesh["offsets"]) - 1):
        uv = mesh["uv"][mesh["offsets"][f] : mesh["offsets"][f + 1]].astype(float)
        x, y = uv[:, 0], uv[:, 1]
        area = (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2
        assert area > 0
        cells.setdefault(int(mesh["patch"][f]), []).append((area, uv.min(axis=0), uv.max(axis=0)))
    boxes = []
    for parts in cells.values():
        low = np.min([p[1] for p in parts], axis=0)
        high = np.max([p[2] for p in parts], axis=0)
        assert sum(p[0] for p in parts) == pytest.approx(np.prod(high - low), rel=1e-3)
        boxes.append((low, high))
    grid = int(np.ceil(np.sqrt(len(boxes))))
    assert len({tuple(np.floor((low + high) / 2 * grid)) for low, high in boxes}) == len(boxes)


@pytest.mark.parametrize("shape, genus, loops", [(sphere, 0, 0), (torus, 1, 0), (bent_sheet, 0, 1)])
@pytest.mark.parametrize("refinement", ["uniform", "adaptive"])
def test_remesh(shape, genus, loops, refinement):
    surface = shape()
    mesh = _native.remesh(*surface, {"vertices": 2000, "refinement": refinement}).final_mesh()
    check_mesh(mesh)
    check_uv(mesh)
    assert (np.diff(mesh["offsets"]) == 4).all() and len(mesh["points"]) <= 2000
    quads = (mesh["points"], mesh["offsets"], mesh["indices"])
    topology = _native.topology(*quads)
    assert (topology["genus"], topology["boundary_loops"], topology["components"]) == (genus, loops, 1)
    assert [topology[name] for name in ("nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges")] == [0, 0, 0]
    assert _native.compare(*surface, *quads)["hausdorff"] < 0.02


@pytest.mark.parametrize("faces, sizes", [("quads", {4}), ("transition", {4, 5, 6}), ("triangles", {3, 4})])
def test_face_closure(faces, sizes):
    result = _native.remesh(*torus(), {"vertices": 1500, "refinement": "adaptive", "faces": faces})
    mesh = result.final_mesh()
    check_mesh(mesh)
    check_uv(mesh)
    assert set(np.diff(mesh["offsets"]).tolist()) <= sizes
    assert result.hierarchy.check() == []


def test_sources_reproduce_positions_on_the_surface(result):
    points, _, indices = result.repaired()
    assert len(result.repaired_source_faces) == len(indices) // 3
    mesh = result.final_mesh()
    weights = mesh["source_weights"].astype(float)
    assert np.allclose(weights.sum(axis=1), 1, atol=1e-5) and (weights > -1e-5).all()
    on_surface = np.einsum("vk,vkd->vd", weights, points[indices.reshape(-1, 3)[mesh["source_face"]]])
    # A fitted vertex lies near the surface, and its source is where it is near.
    drift = np.linalg.norm(on_surface - mesh["points"], axis=1)
    edge = np.median(np.linalg.norm(np.diff(mesh["points"][mesh["indices"].reshape(-1, 4)[:, :2]], axis=1), axis=2))
    assert np.percentile(drift, 99) < 0.25 * edge and drift.max() < edge


def test_report(result):
    report = json.loads(result.report)
    assert report["input"]["vertices"] == 48 * 24 and report["input"]["genus"] == 1
    assert report["final"]["vertices"] == len(result.final_mesh()["points"])
    assert {"settings", "peak_memory_bytes"}.isdisjoint(report)


def test_levels(result):
    hierarchy = result.hierarchy
    names = hierarchy.level_names
    assert names[0] == "N0" and len(set(names)) == len(names) and all(name[0] in "MN" for name in names)
    sizes = []
    for name in names:
        mesh = hierarchy.level(name)
        check_mesh(mesh)
        check_uv(mesh)
        sizes.append(len(mesh["offsets"]) - 1)
    assert sizes == sorted(sizes)
    for name in ["N99", "M0x", "", "final"]:
        with pytest.raises(_native.InvalidInput, match="no level"):
            hierarchy.level(name)
    final = hierarchy.final_mesh()
    assert {key: value.tolist() for key, value in final.items()} == {key: value.tolist() for key, value in result.final_mesh().items()}


def test_a_saved_hierarchy_is_loaded_again(result, tmp_path):
    path = tmp_path / "torus.hmesh"
    result.save(path, '{"name": "Töpfchen"}')
    loaded = _native.load_hierarchy(path)
    assert json.loads(loaded.metadata) == {"name": "Töpfchen"}
    assert loaded.check() == [] and loaded.info() == result.hierarchy.info()
    for name in loaded.level_names:
        ours, theirs = result.hierarchy.level(name), loaded.level(name)
        assert all(np.array_equal(ours[key], theirs[key]) for key in ours if key not in ("patch", "opened", "opened_level"))
    again = tmp_path / "again.hmesh"
    loaded.save(again)
    assert again.read_bytes() == path.read_bytes()


def test_files_that_are_no_hierarchy(tmp_path):
    with pytest.raises(_native.IoError):
        _native.load_hierarchy(tmp_path / "absent.hmesh")
    for content in [b"", b"ply\n", b"\0" * 4096]:
        path = tmp_path / "bad.hmesh"
        path.write_bytes(content)
        with pytest.raises(_native.CorruptStream):
            _native.load_hierarchy(path)


def test_the_result_depends_on_neither_run_nor_threads(tmp_path):
    files = []
    for threads in (1, 2, 2):
        path = tmp_path / f"{len(files)}.hmesh"
        _native.remesh(*torus(), {"vertices": 1500, "threads": threads}).save(path)
        files.append(path.read_bytes())
    assert files[0] == files[1] == files[2]


@pytest.mark.parametrize(
    "name, value",
    [
        ("vertices", -1),
        ("vertices", 2.5),
        ("vertices", True),
        ("vertices", "many"),
        ("error", -0.1),
        ("error", float("nan")),
        ("error", "small"),
        ("levels", 99),
        ("refinement", "Uniform"),
        ("refinement", 1),
        ("faces", "ngons"),
        ("base", "max"),
        ("base", 0),
        ("stretch_threshold", 0),
        ("semi_regular", 1),
        ("effort", "high"),
        ("drop_components", 1.0),
        ("strict", "yes"),
        ("seed", -1),
        ("threads", -1),
        ("seed", 2**70),
        ("vertexes", 1000),
    ],
)
def test_settings_that_cannot_be_used_are_named(name, value):
    with pytest.raises(_native.InvalidInput, match=name):
        _native.remesh(*cube(), {name: value})
    with pytest.raises(_native.InvalidInput, match=name):
        _native.start_remesh(*cube(), {name: value})


@pytest.mark.parametrize("quads", [40, 100, 300])
@pytest.mark.parametrize("mesh", [sphere(), torus(), bent_sheet()], ids=["sphere", "torus", "sheet"])
def test_a_base_of_a_given_size_has_that_size(mesh, quads):
    result = _native.remesh(*mesh, {"base": quads, "levels": 1})
    assert json.loads(result.report)["base"]["quads"] == quads
    assert len(result.hierarchy.level("N0")["offsets"]) - 1 == quads


def test_numpy_numbers_are_settings():
    job = _native.start_remesh(*sphere(6), {"vertices": np.int64(500), "error": np.float32(0), "levels": np.int32(1)})
    assert job.wait(60) and len(job.result().final_mesh()["points"]) <= 500


def test_job():
    job = _native.start_remesh(*torus(), SETTINGS)
    seen = [0.0]
    while not job.done:
        seen.append(job.progress)
        assert isinstance(job.stage, str)
        time.sleep(0.002)
    assert seen == sorted(seen) and seen[-1] <= 1 and job.wait(0)
    result = job.result()
    assert job.progress == 1 and job.result().report == result.report
    points = result.final_mesh()["points"]
    assert np.array_equal(points, _native.remesh(*torus(), SETTINGS).final_mesh()["points"])


def test_a_job_owns_its_arrays():
    points, offsets, indices = torus()
    job = _native.start_remesh(points, offsets, indices, SETTINGS)
    points[:] = 0
    indices[:] = 0
    assert np.ptp(job.result().final_mesh()["points"]) > 1


def test_a_job_ends_soon_after_it_is_cancelled():
    job = _native.start_remesh(*torus(400, 200), {"vertices": 100000})
    assert not job.wait(0.05)
    start = time.perf_counter()
    job.cancel()
    assert job.wait(30) and time.perf_counter() - start < 0.5
    with pytest.raises(_native.Cancelled):
        job.result()
    assert job.progress < 1


def test_a_failed_job_says_why():
    points, offsets, indices = cube()
    job = _native.start_remesh(points * 0, offsets, indices, {})
    for _ in range(2):
        with pytest.raises(_native.InvalidInput):
            job.result()
    assert job.done


def test_shutdown_ends_every_job():
    jobs = [_native.start_remesh(*torus(200, 100), {"vertices": 50000}) for _ in range(3)]
    _native.shutdown_jobs()
    assert all(job.done for job in jobs)
    _native.shutdown_jobs()
    assert len(_native.remesh(*sphere(6), {"vertices": 500}).final_mesh()["points"]) <= 500


def run_python(code):
    source = "import sys; sys.path[:0] = " + repr(sys.path) + "\n" + code
    return subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, timeout=120)


def test_the_interpreter_ends_cleanly_while_a_job_runs():
    ended = run_python(
        "from hybrid_mesh import _native\nfrom shapes import torus\n"
        "job = _native.start_remesh(*torus(400, 200), {'vertices': 100000})\njob.wait(0.05)\n"
    )
    assert (ended.returncode, ended.stderr) == (0, "")


def test_an_interrupt_ends_a_remesh():
    # Shells start what runs in the background with interrupts ignored.
    ended = run_python(
        "import os, signal, threading\nfrom hybrid_mesh import _native\nfrom shapes import torus\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "mesh = torus(400, 200)\n"
        "try:\n    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        "    _native.remesh(*mesh, {'vertices': 100000})\n    print('finished')\n"
        "except KeyboardInterrupt:\n    print('interrupted')\n"
    )
    assert (ended.stdout, ended.stderr) == ("interrupted\n", "")


def test_an_operation_is_copied_to_another_region():
    mesh = sphere(12)
    corners = [[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    plan = {"format": "hybrid-mesh plan", "version": 1, "base": {"nodes": corners, "quads": quads}}
    tower = {"level": 2, "quads": ["1.0.2", "1.1.3"], "layout": "cubes", "height": 2, "buffer_rings": 1}
    settings = {"levels": 3}
    first = _native.remesh(*mesh, {**settings, "plan": json.dumps({**plan, "operations": [tower]})}).hierarchy
    assert first.operation_count == 1
    operation = first.operation(0)
    assert set(operation) == {"kind", "level", "quads", "opens", "corners", "start", "new_quads"}
    assert operation["opens"] == []
    assert operation["kind"] == "add_cubes" and operation["level"] == 2 and operation["corners"] == 6
    assert sorted(operation["quads"]) == tower["quads"] and operation["start"][0] in tower["quads"] and len(operation["new_quads"]) == 14

    def copied(quads, start):
        copy = {"level": 2, "quads": quads, "layout": "template", "start": start, "new_quads": operation["new_quads"]}
        return json.dumps({**plan, "operations": [tower, copy]})

    # The same place in another quad of the base.
    start = ["3" + operation["start"][0][1:], operation["start"][1]]
    both = _native.remesh(*mesh, {**settings, "plan": copied(["3.0.2", "3.1.3"], start)}).hierarchy
    assert both.check() == [] and both.operation_count == 2
    assert both.operation(0)["new_quads"] == both.operation(1)["new_quads"] == operation["new_quads"]
    with pytest.raises(_native.InvalidInput, match=r"operations\[1\].*boundary of 6 sides, and the region one of 4"):
        _native.remesh(*mesh, {**settings, "plan": copied(["3.0.2"], ["3.0.2", 0])})
    for wrong in (-1, 1):
        with pytest.raises(_native.InvalidInput, match=f"no operation {wrong}"):
            first.operation(wrong)


def write_stl(path, points, triangles):
    """As text, whose numbers are exact."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex %r %r %r\n" % tuple(map(float, points[corner])) for corner in triangle) + "endloop\nendfacet\n"
        for triangle in triangles
    )
    path.write_text(f"solid a part\n{facets}endsolid a part\n")


@pytest.mark.parametrize("scale, shift", [(1e-3, 0), (1e3, 0), (1, 1e6), (1e-3, 1e6)])
def test_the_unit_and_the_place_of_a_part_do_not_matter(tmp_path, result, scale, shift):
    points, _, indices = torus()
    write_stl(tmp_path / "part.stl", scale * points + [shift, -shift, shift], indices.reshape(-1, 3))
    moved = _native.remesh(*_native.read_mesh(str(tmp_path / "part.stl")), SETTINGS)
    report, expected = json.loads(moved.report), json.loads(result.report)
    assert report["input"]["repaired"] == expected["input"]["repaired"] and report["warnings"] == expected["warnings"]
    for key in ("vertices", "quads", "genus", "components", "boundary_loops"):
        assert report["final"][key] == expected["final"][key]
    for key in ("l2", "hausdorff"):
        assert report["final"][key] == pytest.approx(expected["final"][key], rel=0.5)
    made = moved.final_mesh()["points"]
    for end in (np.min, np.max):
        assert (end(made, axis=0) - [shift, -shift, shift]) / scale == pytest.approx(end(points, axis=0), abs=0.05)


def ball_with_arms(count=6, length=3.0, step=0.06):
    """Curved arms that taper from a quarter of the ball's radius to a sixth of that."""

    radii = np.linspace(0.25, 0.04, 4)

    def arm(number):
        angle, turn = 2 * np.pi * number / count, (-1) ** number
        outward, up = np.array([np.cos(angle), np.sin(angle), 0]), np.array([0, 0, turn * length])
        return [0.8 * outward, (1 + 0.4 * length) * outward + 0.15 * up, (1 + 0.75 * length) * outward, (1 + length) * outward - 0.2 * up]

    def distance(points):
        found = np.linalg.norm(points, axis=-1) - 1
        for number in range(count):
            places = arm(number)
            for start, end, wide, narrow in zip(places, places[1:], radii, radii[1:]):
                found = implicit_shapes.union(found, implicit_shapes.limb(points, start, end, wide, narrow), 0.05)
        return found

    size = np.array([length + 1.3, length + 1.3, 0.3 * length + 1.4])
    points, triangles = implicit_shapes.zero_set(distance, -size, size, step)
    points = implicit_shapes.evened(distance, points, triangles, step)
    return points, np.arange(0, triangles.size + 1, 3), triangles.astype(np.int32).ravel()


def test_thin_arms_get_a_base_that_reaches_their_ends():
    """One whose maps leave out the ends is not fitted: no fit brings it there, and what comes near is sheared."""
    result = _native.remesh(*_native.repair(*ball_with_arms())[:3], {"vertices": 4000})
    report = json.loads(result.report)
    final = report["final"]
    width = np.sqrt(1 / final["vertices"])
    assert report["verdict"]["result"] == "good"
    assert final["scaled_jacobian"]["p50"] > 0.93
    assert final["hausdorff"] < width
    assert final["l2"] < 0.02 * width
