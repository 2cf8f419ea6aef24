# SPDX-License-Identifier: GPL-3.0-or-later
import csv
import json
import os
import subprocess
import sys

import bpy
import numpy
import pytest

from conftest import PACKAGE, module


@pytest.fixture
def files(world, tmp_path):
    """A mesh file and a .blend with a hidden object, one with modifiers, one that cannot be done."""
    world.scan("first scan", location=(5, 0, 0), scale=(-1, 2, 1))
    second = world.box("Größe 猫")
    second.modifiers.new("Subdivision", "SUBSURF").levels = 3
    second.hide_set(True)
    second.hide_viewport = True
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("no faces", bpy.data.meshes.new("no faces")))
    bpy.ops.object.camera_add()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    points, offsets, indices = world.evaluated(bpy.data.objects["first scan"])
    world.native().write_mesh(str(tmp_path / "mesh.ply"), points, offsets, indices)
    return tmp_path


def run(*arguments):
    return module("core.cli").run([str(argument) for argument in arguments])


def summary(folder):
    with open(folder / "summary.csv", encoding="utf-8", newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def test_mesh_files(files, capfd):
    assert run("remesh", files / "mesh.ply", "--output", files / "out", "--vertices", 1000, "--export", "ply,obj") == 0
    assert sorted(os.listdir(files / "out")) == ["mesh.hmesh", "mesh.obj", "mesh.plan.json", "mesh.ply", "mesh.report.json", "summary.csv"]
    assert run("compare", files / "mesh.ply", files / "out" / "mesh.ply") == 0
    assert run("info", "--check", files / "out" / "mesh.hmesh") == 0
    assert capfd.readouterr().err == ""


def test_blender_imports_the_glb_that_is_written(files):
    options = ("--base-quads", "min", "--levels", 2, "--effort", "quick")
    assert run("remesh", files / "mesh.ply", "--output", files / "out", *options, "--export", "ply,glb", "--export-levels", "glb") == 0
    native = module("_native")
    points, offsets, indices = native.read_mesh(str(files / "out" / "mesh.ply"))
    module("compat").give_numpy_its_old_names()
    for name, finest in (("mesh.glb", "mesh"), ("mesh.levels.glb", "N2")):
        before = set(bpy.data.objects)
        bpy.ops.import_scene.gltf(filepath=str(files / "out" / name))
        # Some versions bring in the coarser levels, too, which the scene does not have.
        (made,) = (item for item in bpy.data.objects if item not in before and item.name.startswith(finest))
        # The importer takes y for what is up.
        placed = numpy.array([made.matrix_world @ vertex.co for vertex in made.data.vertices])[:, [0, 2, 1]] * [1, 1, -1]
        triangles = numpy.array([tuple(face.vertices) for face in made.data.polygons])
        assert triangles.shape == (2 * (len(offsets) - 1), 3) and len(made.data.uv_layers) == 1
        apart = native.compare(points, offsets, indices, placed, 3 * numpy.arange(len(triangles) + 1), triangles.ravel().astype(numpy.int32), 20000)
        # Quads that are not flat may be split along either diagonal.
        assert apart["l2"] < 0.02


def test_each_mesh_object_of_a_blend_is_an_input(files, capfd):
    assert run("remesh", files / "scene.blend", files / "mesh.ply", "--output", files / "out", "--vertices", 1000, "--export", "ply") == 1
    rows = summary(files / "out")
    assert {name: row["status"] for name, row in rows.items()} == {"first scan": "done", "Größe 猫": "done", "no faces": "failed", "mesh": "done"}
    error = capfd.readouterr().err
    assert "no faces" in error and len(error.strip().splitlines()) == 1
    native = module("_native")
    # The object of the .blend, in world space, is the mesh that was exported in world space.
    assert native.compare(*native.read_mesh(str(files / "mesh.ply")), *native.read_mesh(str(files / "out" / "first scan.ply")), 10000)["hausdorff"] < 0.02
    points = native.read_mesh(str(files / "out" / "Größe 猫.ply"))[0]
    assert abs(points).max() < 1  # the modifier was applied


def test_a_farm_does_the_objects_of_a_blend_one_by_one(files, capfd):
    options = ("--base-quads", "min", "--levels", 1, "--effort", "quick")
    assert run("remesh", files / "scene.blend", "--output", files / "farm", *options, "--farm") == 0
    batch = files / "farm" / "batch.json"
    for name in ("first scan", "no faces"):
        bpy.data.objects.remove(bpy.data.objects[name])
    bpy.ops.wm.save_as_mainfile(filepath=str(files / "scene.blend"))
    numbers = {name: number for number, name in enumerate(json.loads(batch.read_text(encoding="utf-8"))["names"], 1)}
    capfd.readouterr()
    assert run("task", batch, numbers["Größe 猫"]) == run("task", batch, numbers["first scan"]) == 0
    assert capfd.readouterr().err.strip().endswith("scene.blend: first scan: is no longer in the file")
    assert run("merge-reports", batch) == 1
    assert {name: row["status"] for name, row in summary(files / "farm").items()} == {"first scan": "failed", "Größe 猫": "done", "no faces": "failed"}
    assert run("remesh", files / "scene.blend", "--output", files / "alone", *options) == 0
    assert (files / "farm" / "Größe 猫.hmesh").read_bytes() == (files / "alone" / "Größe 猫.hmesh").read_bytes()


def test_one_name_twice_gets_two_names(files, capfd):
    (files / "first scan.ply").write_bytes((files / "mesh.ply").read_bytes())
    assert run("remesh", files / "scene.blend", files / "first scan.ply", "--output", files / "out", "--vertices", 1000) == 1  # an object has no faces
    assert "first scan-2" in capfd.readouterr().out
    rows = summary(files / "out")
    assert rows["first scan"]["input"].endswith("first scan.ply") and rows["first scan-2"]["input"].endswith("scene.blend: first scan")


@pytest.fixture
def exported(world, tmp_path):
    """The same two objects, one below the other, in a file of each kind that Blender imports; and where they are."""
    scan = world.scan("first scan", location=(5, 1, 0), rotation_euler=(0.3, 0.2, 0.1), scale=(1, 2, 1))
    box = world.box("Größe 猫", location=(0, 0, 3))
    box.parent = scan
    bpy.context.view_layer.update()
    expected = {obj.name: world.evaluated(obj) for obj in (scan, box)}
    module("compat").give_numpy_its_old_names()
    bpy.ops.export_scene.gltf(filepath=str(tmp_path / "scene.glb"))
    bpy.ops.export_scene.gltf(filepath=str(tmp_path / "scene.gltf"), export_format="GLTF_SEPARATE")
    bpy.ops.export_scene.fbx(filepath=str(tmp_path / "scene.fbx"))
    return tmp_path, expected


@pytest.mark.parametrize("name", ["scene.glb", "scene.gltf", "scene.fbx"])
def test_each_mesh_object_of_what_blender_imports_is_an_input(world, exported, capfd, name):
    folder, expected = exported
    assert run("remesh", folder / name, "--output", folder / "out", "--vertices", 1000, "--export", "ply", "--export-repaired") == 0
    assert capfd.readouterr().err == ""
    assert {key: row["status"] for key, row in summary(folder / "out").items()} == dict.fromkeys(expected, "done")
    native = world.native()
    for key, mesh in expected.items():
        # Where it stood in world space, and closed again although the file repeats a vertex for each of its normals.
        made = native.read_mesh(str(folder / "out" / f"{key}.repaired.ply"))
        assert native.compare(*mesh, *made, 10000)["hausdorff"] < 1e-4 and native.topology(*made)["boundary_loops"] == 0
        assert world.volume(made) == pytest.approx(world.volume(mesh), rel=1e-3)
        assert json.loads((folder / "out" / f"{key}.report.json").read_text())["input"]["object"] == key


def test_the_scenes_in_a_folder_are_inputs(exported, capfd):
    folder, _ = exported
    assert run("remesh", folder, "--output", folder / "out", "--vertices", 500) == 0
    error = capfd.readouterr().err
    assert len(error.strip().splitlines()) == 1 and "scene.bin" in error
    assert {key: row["input"].partition(": ")[0] for key, row in summary(folder / "out").items() if "first" in key} == {
        "first scan": str(folder / "scene.fbx"), "first scan-2": str(folder / "scene.glb"), "first scan-3": str(folder / "scene.gltf"),
    }  # fmt: skip


@pytest.mark.parametrize("name", ["bad.glb", "bad.gltf", "bad.fbx"])
@pytest.mark.parametrize("content", [b"", b"nothing of the kind", b"glTF\2\0\0\0\xff\0\0\0", b"Kaydara FBX Binary  \0\x1a\0\xe8\x1c\0\0\xff", b'{"asset": {"version": "2.0"}}'])
def test_a_scene_that_is_none(tmp_path, capfd, name, content):
    (tmp_path / name).write_bytes(content)
    assert run("remesh", tmp_path / name, "--output", tmp_path / "out") == 1
    error = capfd.readouterr().err
    assert len(error.strip().splitlines()) == 1 and f"{name}: " in error and "crashed" not in error
    assert summary(tmp_path / "out")["bad"]["status"] == "failed"


def test_a_blender_without_an_importer(tmp_path, monkeypatch):
    files = module("bridge.blend_files")
    (tmp_path / "scene.fbx").write_bytes(b"x")
    monkeypatch.setitem(files.IMPORTERS, ".fbx", (("wm", "no_such_import", None), ("import_scene", "no_such", "io_no_such")))
    with pytest.raises(ValueError, match="no importer for .fbx files"):
        files.extract(str(tmp_path / "scene.fbx"), str(tmp_path))


def test_shapes_of_bones_are_no_inputs(world, tmp_path):
    world.scan("surface", subdivisions=2)
    shape = world.box("shape")
    bpy.ops.object.armature_add()
    bpy.context.object.pose.bones[0].custom_shape = shape
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "rig.blend"))
    assert [entry["name"] for entry in module("bridge.blend_files").extract(str(tmp_path / "rig.blend"), str(tmp_path))] == ["surface"]


def test_a_blend_with_the_levels(files, capfd):
    assert run("remesh", files / "mesh.ply", "--output", files / "out", "--vertices", 1000, "--blend") == 0
    bpy.ops.wm.open_mainfile(filepath=str(files / "out" / "mesh.blend"))
    collection = bpy.data.collections["mesh hierarchy"]
    report = json.loads((files / "out" / "mesh.report.json").read_text())
    assert module("features.levels.properties").report_of(collection)["final"] == report["final"]
    preview = bpy.data.objects["mesh.preview"]
    sizes = [level["quads"] for level in report["levels"]]
    for number, size in enumerate(sizes):
        module("bridge.levels").set_level(preview, number)
        assert len(preview.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons) == size


@pytest.mark.parametrize("content", [b"", b"BLENDER", b"nothing of the kind"])
def test_a_blend_that_is_none(files, capfd, content):
    (files / "bad.blend").write_bytes(content)
    assert run("remesh", files / "bad.blend", files / "mesh.ply", "--output", files / "out", "--vertices", 500) == 1
    error = capfd.readouterr().err
    assert len(error.strip().splitlines()) == 1 and "bad.blend" in error
    assert summary(files / "out")["mesh"]["status"] == "done" and summary(files / "out")["bad"]["status"] == "failed"


def blender(*arguments):
    """The command line as design says it is reached from outside."""
    if not bpy.app.binary_path:
        expression = f"import sys, bpy; sys.path.insert(0, {os.path.dirname(os.path.dirname(module('').__file__))!r}); from hybrid_mesh.core import cli; cli.main({list(map(str, arguments))!r})"
        command = [sys.executable, "-c", expression]
    else:
        command = [
            bpy.app.binary_path, "--background", "--factory-startup", "--python-exit-code", "1", "--addons", PACKAGE,
            "--python-expr", f"from {PACKAGE}.core import cli; cli.main()", "--", *map(str, arguments),
        ]  # fmt: skip
    return subprocess.run(command, capture_output=True, encoding="utf-8", timeout=300)


def test_exit_codes_from_outside(files):
    good = blender("remesh", files / "mesh.ply", "--output", files / "out", "--vertices", 500)
    assert good.returncode == 0, good.stderr
    assert (files / "out" / "mesh.hmesh").is_file()
    bad = blender("remesh", files / "none.ply", "--output", files / "out", "--vertices", 500)
    assert bad.returncode == 1 and "none.ply: No such file" in bad.stderr and "Traceback" not in bad.stderr + bad.stdout
    wrong = blender("remesh", "--output", files / "out")
    assert wrong.returncode == 2 and "INPUT" in wrong.stderr


def test_the_registered_command(files):
    assert module("registration")._run_command_line(["info", str(files / "none.hmesh")]) == 1
