# SPDX-License-Identifier: GPL-3.0-or-later
"""Hybrid mesh files into the scene and out of it."""

import json
import os

import bpy
import mathutils
import numpy
import pytest
from conftest import module
from file_tools import clear, export_hmesh, import_hmesh, native_of, scene_contents, written_stream
from test_level_editing import activate, edit, move, places, refused


PLACED = {"location": (3, 2, 1), "rotation_euler": (0.3, 0.2, 0.1), "scale": (1, -2, 0.5)}


@pytest.fixture
def container(world, tmp_path):
    """A file, and what it was written of: the native levels, the places of the objects, and where the preview stands."""
    collection, levels, preview = world.remesh(world.scan(**PLACED))
    path = tmp_path / "head.hmesh"
    export_hmesh(world, preview, path)
    native = native_of(collection)
    points = {name: native.level_points(name) for name in native.level_names}
    held = {obj.hybrid_mesh.level: (places(obj), world.evaluated(obj)) for obj in levels}
    clear()
    return path, points, held


@pytest.fixture
def stream(world, tmp_path):
    return written_stream(world, tmp_path)


def test_a_container_comes_back_bit_for_bit(world, container):
    path, points, held = container
    collection, levels, preview = import_hmesh(world, path)
    assert collection.name == "head hierarchy" and preview.name == "head.preview" and list(levels) == list(points)
    native = native_of(collection)
    for name, obj in levels.items():
        assert obj.name == f"head.{name}"
        assert numpy.array_equal(native.level_points(name), points[name])
        assert numpy.array_equal(places(obj), held[name][0])
        for one, other in zip(world.evaluated(obj), held[name][1]):
            assert numpy.allclose(one, other, atol=1e-5)
        assert {"stretch", "patch", "irregular", "root", "path"} <= {attribute.name for attribute in obj.data.attributes}
        assert "patches" in obj.data.uv_layers and obj.hide_get() and obj.hide_render
    report = module("features.levels.properties").report_of(collection)
    assert report["verdict"]["result"] == "good" and report["final"]["vertices"] == len(held[list(held)[-1]][0])
    # What was not measured is not shown.
    assert module("core.report").quality(report)["irregular_vertices"] is module("core.report").quality(report)["l2"] is None
    assert collection.hybrid_mesh.source is None and collection.hybrid_mesh.file == str(path)


def test_the_command_lines_file_is_the_same_mesh(world, tmp_path):
    """Whose metadata says nothing of objects."""
    hierarchy = world.native().remesh(*world.evaluated(world.scan()), {"vertices": 1000}).hierarchy
    hierarchy.save(str(tmp_path / "a.hmesh"), json.dumps({"name": "a", "settings": {}, "verdict": {"result": "good", "reasons": []}}))
    hierarchy.save(str(tmp_path / "b.hmesh"))
    for name, verdict in (("a", {"result": "good", "reasons": []}), ("b", None)):
        collection, levels, preview = import_hmesh(world, tmp_path / f"{name}.hmesh")
        assert preview.matrix_world == mathutils.Matrix()
        for level, obj in levels.items():
            assert numpy.array_equal(places(obj), hierarchy.level_points(level).astype(numpy.float32))
        assert module("features.levels.properties").report_of(collection)["verdict"] == verdict


def test_an_import_is_edited_as_a_remesh_is(world, container):
    _, levels, preview = import_hmesh(world, container[0])
    activate(world, levels["N1"])
    before, finest = places(levels["N0"]), list(levels)[-1]
    expected = places(levels[finest]) + (0, 0, 1)
    edit(levels["N1"], lambda points: points + (0, 0, 1))
    assert numpy.abs(places(levels[finest]) - expected).max() < 1e-5 and numpy.array_equal(places(levels["N0"]), before)
    move(levels["N1"], lambda points: points * 2)
    assert bpy.ops.hybrid_mesh.reset_level() == {"FINISHED"}
    assert bpy.ops.hybrid_mesh.show_level(level=0) == {"FINISHED"}
    assert len(world.evaluated(preview)[0]) == len(before)
    levels["N1"].data.polygons[0].select = True
    refused(bpy.ops.hybrid_mesh.repatch_region, "was imported", layout_kind="AUTOMATIC")


def test_what_was_edited_and_carried_is_in_the_file(world, container, tmp_path):
    collection, levels, _ = import_hmesh(world, container[0])
    activate(world, levels["N1"])
    edit(levels["N1"], lambda points: points + (0, 0, 1))
    held = {name: places(obj) for name, obj in levels.items()}
    # What was not carried is not, and that is said.
    move(levels["N0"], lambda points: points * 2)
    exporting = module("features.files.exporting")
    assert exporting.not_carried(collection) == ["head.N0"]
    export_hmesh(world, levels["N1"], tmp_path / "edited.hmesh")
    clear()
    collection, levels, _ = import_hmesh(world, tmp_path / "edited.hmesh")
    assert all(numpy.array_equal(places(obj), held[name]) for name, obj in levels.items())
    assert module("features.levels.kept").at_hand(collection).edited
    assert module("features.levels.properties").report_of(collection)["verdict"] is None


def test_any_object_of_the_hierarchy_exports_the_same(world, tmp_path):
    source = world.scan()
    _, levels, preview = world.remesh(source)
    contents = set()
    for number, obj in enumerate((source, preview, *levels)):
        export_hmesh(world, obj, tmp_path / f"{number}.hmesh")
        contents.add((tmp_path / f"{number}.hmesh").read_bytes())
    assert len(contents) == 1


def test_objects_come_back_where_they_were_moved_to(world, tmp_path):
    _, levels, preview = world.remesh(world.scan(**PLACED))
    for obj in (preview, *levels):
        obj.matrix_world = mathutils.Matrix.Translation((10, 0, 0)) @ mathutils.Matrix.Rotation(1, 4, "X") @ obj.matrix_world
    bpy.context.view_layer.update()
    seen = world.evaluated(preview)
    native = native_of(preview.hybrid_mesh.hierarchy)
    points = native.level_points("N0")
    export_hmesh(world, preview, tmp_path / "a.hmesh")
    export_hmesh(world, preview, tmp_path / "b.hmesh", kind="STREAM")
    clear()
    collection, levels, preview = import_hmesh(world, tmp_path / "a.hmesh")
    assert numpy.abs(world.evaluated(preview)[0] - seen[0]).max() < 1e-5
    assert numpy.array_equal(native_of(collection).level_points("N0"), points)
    activate(world, levels["N1"])
    refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")
    # A stream has no place for where objects stand: its points are in the world.
    _, _, streamed = import_hmesh(world, tmp_path / "b.hmesh")
    assert streamed.matrix_world == mathutils.Matrix() and world.distance(preview, streamed)["hausdorff"] < 1e-4
    # Its faces look outward; the mesh of an object that mirrors has them turned over.
    assert abs(world.volume(world.evaluated(preview)) + world.volume(world.evaluated(streamed))) < 1e-2 < world.volume(world.evaluated(streamed))


def test_shear_goes_into_the_mesh(world, tmp_path):
    scan = world.scan(rotation_euler=(0.5, 0.4, 0.3))
    parent = bpy.data.objects.new("parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale = (1, 3, 0.5)
    scan.parent = parent
    _, _, preview = world.remesh(scan)
    seen = world.evaluated(preview)[0]
    export_hmesh(world, preview, tmp_path / "a.hmesh")
    clear()
    _, levels, preview = import_hmesh(world, tmp_path / "a.hmesh")
    assert numpy.abs(world.evaluated(preview)[0] - seen).max() < 1e-5
    activate(world, levels["N1"])
    refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")


def test_a_mirrored_hierarchy_has_no_stream(world, tmp_path):
    _, levels, preview = world.remesh(world.scan())
    preview.scale.x = -1
    world.select(preview)
    refused(bpy.ops.hybrid_mesh.export_hmesh, "was mirrored since", filepath=str(tmp_path / "a.hmesh"), kind="STREAM")
    assert not (tmp_path / "a.hmesh").exists()


def test_several_files_at_once(world, container, stream):
    paths = [container[0], stream[0]]
    (paths[0].parent / "bad.hmesh").write_bytes(b"nothing of the kind")
    files = [{"name": path.name} for path in paths]
    assert bpy.ops.hybrid_mesh.import_hmesh(directory=str(paths[0].parent), files=files) == {"FINISHED"}
    names = {"head.preview", "small.preview"}
    assert {obj.name for obj in bpy.context.selected_objects} == names
    clear()
    # One that is bad leaves the others done.
    refused(bpy.ops.hybrid_mesh.import_hmesh, "^Error: bad.hmesh: [^\n]*\n?$", directory=str(paths[0].parent), files=[*files, {"name": "bad.hmesh"}])
    assert {obj.name for obj in bpy.context.selected_objects} == names
    assert not [name for name in bpy.data.objects.keys() if "bad" in name]


def test_many_files_stay_at_hand(world, container):
    """More than there is room for in memory."""
    for _ in range(10):
        import_hmesh(world, container[0])
    module("features.levels.kept").forget()
    for obj in bpy.data.objects:
        if obj.hybrid_mesh.role == "LEVEL" and obj.hybrid_mesh.level == "N1":
            activate(world, obj)
            refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")


def bad_files(good_container, good_stream):
    newer_container, newer_stream = bytearray(good_container), bytearray(good_stream)
    newer_container[8], newer_stream[3] = 9, 9
    flipped = bytearray(good_container)
    flipped[len(flipped) // 2] ^= 1
    return {
        "empty": (b"", "the file is empty"),
        "truncated": (good_container[: len(good_container) // 2], "not a valid hierarchy file"),
        "flipped": (bytes(flipped), "not a valid hierarchy file: section .* has a wrong checksum"),
        "begins": (good_container[:5], "not a valid hierarchy file"),
        "short": (good_stream[:12], "not a valid hierarchy stream: it ends before its base does"),
        "foreign": (b"ply\nformat ascii 1.0\n", "not a valid hierarchy file: it starts with other bytes"),
        "newer": (bytes(newer_container), "a hierarchy file of version 9, newer than this program"),
        "newer_stream": (bytes(newer_stream), "a hierarchy stream of version 9, newer than this program"),
    }


def test_bad_files_are_one_line_each_and_leave_nothing(world, container, stream, tmp_path, capfd):
    before = scene_contents()
    for name, (data, words) in bad_files(container[0].read_bytes(), stream[0].read_bytes()).items():
        path = tmp_path / f"{name}.hmesh"
        path.write_bytes(data)
        refused(bpy.ops.hybrid_mesh.import_hmesh, f"^Error: {name}.hmesh: {words}[^\n]*\n?$", filepath=str(path))
    refused(bpy.ops.hybrid_mesh.import_hmesh, "^Error: missing.hmesh: No such file or directory\n?$", filepath=str(tmp_path / "missing.hmesh"))
    (tmp_path / "folder.hmesh").mkdir()
    refused(bpy.ops.hybrid_mesh.import_hmesh, "^Error: folder.hmesh: Is a directory\n?$", filepath=str(tmp_path / "folder.hmesh"))
    assert scene_contents() == before and "Traceback" not in capfd.readouterr().err


def test_damaged_streams_are_one_line_or_a_mesh(world, stream, tmp_path, capfd):
    """They have no checksum: some of what is damaged is another hierarchy."""
    data, random, before = stream[0].read_bytes()[:1000], numpy.random.default_rng(1), scene_contents()
    outcomes = []
    for _ in range(100):
        damaged = bytearray(data)
        damaged[random.integers(4, 100)] ^= 1 << random.integers(8)
        (tmp_path / "damaged.hmesh").write_bytes(damaged)
        try:
            outcomes.append(bpy.ops.hybrid_mesh.import_hmesh(filepath=str(tmp_path / "damaged.hmesh")) == {"FINISHED"})
            clear()
        except RuntimeError as error:
            assert str(error).startswith("Error: damaged.hmesh: ") and str(error).strip().count("\n") == 0 and "internal" not in str(error)
            assert scene_contents() == before
            outcomes.append(False)
    assert True in outcomes and False in outcomes and "Traceback" not in capfd.readouterr().err


def test_levels_that_are_no_meshes_are_refused(world, stream, monkeypatch):
    before = scene_contents()

    def refuse(*_):
        raise module("bridge.meshes").MeshError("no mesh")

    monkeypatch.setattr(module("bridge.meshes"), "new_mesh", refuse)
    refused(bpy.ops.hybrid_mesh.import_hmesh, "^Error: small.hmesh: it is damaged: its levels are no meshes\n?$", filepath=str(stream[0]))
    assert scene_contents() == before


def test_places_that_blender_cannot_hold(world, container, tmp_path):
    hierarchy = world.native().load_hierarchy(str(container[0]))
    hierarchy.set_level("N0", 1e60 * hierarchy.level_points("N0"))
    hierarchy.save(str(tmp_path / "far.hmesh"))
    before = scene_contents()
    refused(bpy.ops.hybrid_mesh.import_hmesh, "far.hmesh: it has vertices farther away", filepath=str(tmp_path / "far.hmesh"))
    assert scene_contents() == before


def test_metadata_of_others_is_no_obstacle(world, container, tmp_path):
    hierarchy = world.native().load_hierarchy(str(container[0]))
    for metadata in ("[]", '{"matrix": "x", "verdict": 3}', json.dumps({"matrix": [0] * 16}), json.dumps({"matrix": [1e300] * 16})):
        hierarchy.save(str(tmp_path / "a.hmesh"), metadata)
        _, levels, preview = import_hmesh(world, tmp_path / "a.hmesh")
        assert preview.matrix_world == mathutils.Matrix()
        assert numpy.array_equal(places(levels["N0"]), hierarchy.level_points("N0").astype(numpy.float32))


def test_a_failure_half_way_leaves_nothing(world, container, stream, monkeypatch):
    before = scene_contents()

    def refuse(*_):
        raise ValueError("no room")

    monkeypatch.setattr(module("features.levels.stored"), "store", refuse)
    monkeypatch.setattr(module("features.levels.streams"), "attach", refuse)
    for path in (container[0], stream[0]):
        refused(bpy.ops.hybrid_mesh.import_hmesh, "no room", filepath=str(path))
        assert scene_contents() == before


def test_export_says_why_it_cannot(world, container, tmp_path):
    assert not bpy.ops.hybrid_mesh.export_hmesh.poll() and not bpy.ops.hybrid_mesh.make_mesh.poll()
    refused(bpy.ops.hybrid_mesh.export_hmesh, "Make a hybrid mesh the active object", filepath=str(tmp_path / "a.hmesh"))
    world.box()
    assert not bpy.ops.hybrid_mesh.export_hmesh.poll()
    import_hmesh(world, container[0])
    refused(bpy.ops.hybrid_mesh.export_hmesh, "a.hmesh: .*No such file or directory", filepath=str(tmp_path / "no folder" / "a.hmesh"))
    bound = {"kind": "STREAM", "bound": "BYTES", "most_bytes": 10}
    refused(bpy.ops.hybrid_mesh.export_hmesh, "a.hmesh: .*the base alone", filepath=str(tmp_path / "a.hmesh"), **bound)
    assert not (tmp_path / "a.hmesh").exists()


def test_streams_keep_to_their_bounds(world, container, tmp_path):
    collection, _, preview = import_hmesh(world, container[0])
    whole = export_hmesh(world, preview, tmp_path / "whole.hmesh", kind="STREAM")
    assert whole < os.path.getsize(container[0]) / 10
    assert export_hmesh(world, preview, tmp_path / "short.hmesh", kind="STREAM", bound="BYTES", most_bytes=1000) == 1000
    assert export_hmesh(world, preview, tmp_path / "near.hmesh", kind="STREAM", bound="ERROR", error=2e-3) < whole
    final = native_of(collection).final_mesh()
    near = world.native().load_hierarchy(str(tmp_path / "near.hmesh")).final_mesh()
    keys = ("points", "offsets", "indices")
    assert world.native().compare(*(final[key] for key in keys), *(near[key] for key in keys), 20000)["l2"] < 2.1e-3
    # A bound that is not asked for does nothing.
    assert export_hmesh(world, preview, tmp_path / "b.hmesh", kind="STREAM", most_bytes=1000, error=0.1) == whole


def test_the_line_says_size_and_bound(world, container, tmp_path, capfd):
    _, _, preview = import_hmesh(world, container[0])
    size = export_hmesh(world, preview, tmp_path / "a.hmesh")
    assert f"a.hmesh: {size:,} bytes\n" in capfd.readouterr().out
    size = export_hmesh(world, preview, tmp_path / "b.hmesh", kind="STREAM", bound="ERROR", error=2e-3)
    assert f"b.hmesh: {size:,} bytes, for an error of 0.002\n" in capfd.readouterr().out
    size = export_hmesh(world, preview, tmp_path / "c.hmesh", kind="STREAM", bound="BYTES", most_bytes=1234)
    assert "c.hmesh: 1,234 bytes, no more than 1,234 asked for\n" in capfd.readouterr().out


def test_undo_and_redo(world, container):
    bpy.ops.ed.undo_push(message="before")
    before = scene_contents()
    assert bpy.ops.hybrid_mesh.import_hmesh("EXEC_DEFAULT", True, filepath=str(container[0])) == {"FINISHED"}
    after = scene_contents()
    held = {obj.name: places(obj) for obj in bpy.data.objects if obj.type == "MESH"}
    bpy.ops.ed.undo()
    assert scene_contents() == before
    bpy.ops.ed.redo()
    assert scene_contents() == after
    assert all(numpy.array_equal(places(bpy.data.objects[name]), points) for name, points in held.items())
    activate(world, bpy.data.objects["head.N1"])
    edit(bpy.data.objects["head.N1"], lambda points: points + (0, 0, 1))


def test_a_saved_file_goes_on(world, container, tmp_path):
    _, levels, _ = import_hmesh(world, container[0])
    held = {obj.name: places(obj) for obj in levels.values()}
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "levels.blend"))
    os.remove(container[0])
    clear()
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "levels.blend"))
    assert all(numpy.array_equal(places(bpy.data.objects[name]), points) for name, points in held.items())
    activate(world, bpy.data.objects["head.N1"])
    refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")
    edit(bpy.data.objects["head.N1"], lambda points: points + (0, 0, 1))
    export_hmesh(world, bpy.context.object, tmp_path / "again.hmesh")


def test_the_file_menus_have_entries_while_the_add_on_is_on():
    registration = module("registration")

    def entries():
        return [entry in menu._dyn_ui_initialize() for menu, entry in module("features.files.operators").MENUS]

    assert all(entries())
    registration.unregister()
    try:
        assert not any(entries())
    finally:
        registration.register()
    assert all(entries())


@pytest.mark.parametrize("name", ["Größe 猫", "a.b c", "x" * 200, os.fsdecode(b"\xff\xfe")])
def test_names_of_files(world, container, tmp_path, name):
    path = tmp_path / f"{name}.hmesh"
    os.rename(container[0], path)
    _, levels, preview = import_hmesh(world, path)
    assert preview.name.endswith(".preview") and len(preview.name.encode()) < 64
    assert preview.name.startswith(name) or len(name) > 60 or not name.isprintable()
    for kind in ("CONTAINER", "STREAM"):
        export_hmesh(world, preview, tmp_path / f"{name} again.hmesh", kind=kind)
        nowhere = str(tmp_path / f"{name} no folder" / "a.hmesh")
        refused(bpy.ops.hybrid_mesh.export_hmesh, "^Error: a.hmesh: [^\n]*\n?$", filepath=nowhere, kind=kind)
    refused(bpy.ops.hybrid_mesh.import_hmesh, "No such file", filepath=str(tmp_path / f"{name} missing.hmesh"))
