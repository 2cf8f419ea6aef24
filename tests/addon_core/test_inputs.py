# SPDX-License-Identifier: GPL-3.0-or-later
import itertools
import os
import time

import pytest
from hybrid_mesh.core import inputs
from hybrid_mesh.core.inputs import Input, InputsError, Outputs


def test_the_report_is_what_appears_last():
    assert Outputs(("ply", "obj"), True, True).suffixes() == [".hmesh", ".plan.json", ".ply", ".obj", ".repaired.ply", ".repaired.obj", ".blend", ".report.json"]


@pytest.mark.parametrize("name, safe", [("Cube", "Cube"), ("a/b\\c", "a_b_c"), ("..", "_."), (".x", "_x"), ("", "_"), ("Größe 猫", "Größe 猫")])
def test_object_names_become_file_names(name, safe):
    assert inputs.file_name(name) == safe


def names(items, outputs=Outputs(), folder="out"):
    inputs.name_apart(items, outputs, folder)
    return {item.label: item.name for item in items}


def test_inputs_of_one_name_are_told_apart_whatever_their_order():
    paths = [("x/a.ply", "a"), ("b/a-2.ply", "a-2"), ("y/a.obj", "a"), ("x/b.ply", "b"), ("x/a.obj", "a")]
    expected = {"x/a.obj": "a", "x/a.ply": "a-3", "y/a.obj": "a-4", "b/a-2.ply": "a-2", "x/b.ply": "b"}
    for order in itertools.permutations(paths):
        assert names([Input(*one) for one in order]) == expected


def test_objects_of_one_name_are_told_apart():
    items = [inputs.object_input(path, name, "") for path in ("q.blend", "p.glb") for name in ("a/b", "a_b", "c")]
    assert names(items) == {"p.glb: a/b": "a_b", "p.glb: a_b": "a_b-2", "q.blend: a/b": "a_b-3", "q.blend: a_b": "a_b-4", "p.glb: c": "c", "q.blend: c": "c-2"}
    assert names(items[::-1]) == {item.label: item.name for item in items}


def test_inputs_that_get_another_name_are_told():
    items = [Input("y/a.ply", "a"), Input("x/a.ply", "a"), Input("b.ply", "b")]
    assert [item.path for item in inputs.name_apart(items, Outputs(), "out")] == ["y/a.ply"]


def test_no_two_inputs_write_one_file_by_another_way():
    items = lambda: [Input("a.obj", "a"), Input("a.repaired.obj", "a.repaired"), Input("a.N1.obj", "a.N1")]
    assert list(names(items(), Outputs(("ply",))).values()) == ["a", "a.repaired", "a.N1"]
    for outputs in (Outputs(("ply",), repaired=True), Outputs(("ply",), levels=("ply",)), Outputs(("ply",), repaired=True, levels=("ply",))):
        made = list(names(items(), outputs).values())
        files = [name + suffix for name in made for suffix in (*outputs.suffixes(), *outputs.level_suffixes(10))]
        assert len(files) == len(set(files)) and made != ["a", "a.repaired", "a.N1"]


def test_many_of_one_name_take_no_time():
    began = time.monotonic()
    made = names([Input(f"{number:05}/model.obj", "model") for number in range(3000)])
    assert time.monotonic() - began < 5 and len(set(made.values())) == 3000 and made["02999/model.obj"] == "model-3000"


def test_an_export_never_overwrites_an_input(tmp_path):
    items = [Input(str(tmp_path / "a.ply"), "a")]
    inputs.name_apart(items, Outputs(), str(tmp_path))
    with pytest.raises(InputsError, match="overwritten"):
        inputs.name_apart(items, Outputs(("ply",)), str(tmp_path))


def test_a_level_never_overwrites_an_input(tmp_path):
    items = [Input(str(tmp_path / "a.N2.ply"), "a.N2"), Input("a.obj", "a")]
    inputs.name_apart(items, Outputs(), str(tmp_path))
    with pytest.raises(InputsError, match="overwritten"):
        inputs.name_apart(items, Outputs(levels=("ply",)), str(tmp_path))


def test_another_name_may_not_overwrite_an_input_either(tmp_path):
    items = [Input(str(tmp_path / "a-2.ply"), "b"), Input("x/a.obj", "a"), Input("y/a.obj", "a")]
    with pytest.raises(InputsError, match="overwritten"):
        inputs.name_apart(items, Outputs(("ply",)), str(tmp_path))


def test_what_is_no_mesh_file_says_so():
    assert ".ply" in inputs.file_input("a.txt").error and ".fbx" in inputs.file_input("a.txt").error
    assert inputs.file_input("a.PLY").error == inputs.file_input("a.Glb").error == ""
    assert inputs.file_input("a.b.ply").name == "a.b"


@pytest.fixture
def folder(tmp_path):
    for name in ("b.ply", "a.OBJ", "scene.glb", "notes.txt", "a.mtl", ".hidden.ply", ".DS_Store", "sub/c.ply", "out/a.hmesh", "folder.ply/x"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"x")
    return tmp_path


def expanded(paths, output):
    lines = []
    items = inputs.expand([str(path) for path in paths], str(output), lines.append)
    return items, lines


def test_a_folder_stands_for_the_meshes_in_it(folder):
    items, lines = expanded([folder], folder / "out")
    assert [item.path for item in items] == [str(folder / name) for name in ("a.OBJ", "b.ply", "scene.glb")]
    assert not any(item.error for item in items)
    assert lines == [f"{folder}: skipped, no mesh files: a.mtl, folder.ply/, notes.txt, sub/"]


def test_of_many_skipped_files_some_are_named(folder):
    for number in range(20):
        (folder / f"z{number:02}.txt").write_bytes(b"")
    lines = expanded([folder], folder / "out")[1]
    assert len(lines) == 1 and lines[0].endswith("sub/, z00.txt and 19 more")


def test_a_file_is_one_input_however_often_it_is_named(folder):
    items, _ = expanded([folder / "b.ply", folder, f"{folder}/sub/../b.ply", folder / "sub"], "out")
    assert [os.path.basename(item.path) for item in items] == ["b.ply", "a.OBJ", "scene.glb", "c.ply"]


@pytest.mark.parametrize("path", ["empty", "empty/", "empty/.", "./empty/sub/.."])
def test_a_folder_without_meshes_is_an_input_that_fails(tmp_path, monkeypatch, path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty" / "sub").mkdir(parents=True)
    (item,), lines = expanded([path], "out")
    assert "without a mesh" in item.error and item.name == "empty" and item.path == path and len(lines) == 1
