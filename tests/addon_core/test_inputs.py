# SPDX-License-Identifier: GPL-3.0-or-later
import pytest
from hybrid_mesh.core import inputs
from hybrid_mesh.core.inputs import Input, InputsError, Outputs


def test_the_report_is_what_appears_last():
    assert Outputs(("ply", "obj"), True, True).suffixes() == [".hmesh", ".plan.json", ".ply", ".obj", ".repaired.ply", ".repaired.obj", ".blend", ".report.json"]


@pytest.mark.parametrize("name, safe", [("Cube", "Cube"), ("a/b\\c", "a_b_c"), ("..", "_."), (".x", "_x"), ("", "_"), ("Größe 猫", "Größe 猫")])
def test_object_names_become_file_names(name, safe):
    assert inputs.file_name(name) == safe


def test_one_name_twice_is_refused(tmp_path):
    items = [Input("x/a.ply", "a"), Input("y/a.obj", "a")]
    with pytest.raises(InputsError, match="x/a.ply and y/a.obj"):
        inputs.refuse_clashes(items, Outputs(), str(tmp_path))


def test_two_inputs_that_write_one_file_by_another_way_are_refused(tmp_path):
    items = [Input("a.obj", "a"), Input("a.repaired.obj", "a.repaired")]
    inputs.refuse_clashes(items, Outputs(("ply",)), str(tmp_path))
    with pytest.raises(InputsError):
        inputs.refuse_clashes(items, Outputs(("ply",), repaired=True), str(tmp_path))


def test_an_export_never_overwrites_an_input(tmp_path):
    items = [Input(str(tmp_path / "a.ply"), "a")]
    inputs.refuse_clashes(items, Outputs(), str(tmp_path))
    with pytest.raises(InputsError, match="overwritten"):
        inputs.refuse_clashes(items, Outputs(("ply",)), str(tmp_path))


def test_a_level_never_overwrites_an_input(tmp_path):
    items = [Input(str(tmp_path / "a.N2.ply"), "a.N2"), Input("a.obj", "a")]
    inputs.refuse_clashes(items, Outputs(), str(tmp_path))
    with pytest.raises(InputsError, match="overwritten"):
        inputs.refuse_clashes(items, Outputs(levels=("ply",)), str(tmp_path))


def test_what_is_no_mesh_file_says_so(tmp_path):
    assert "folder" in inputs.file_input(str(tmp_path)).error
    assert ".ply" in inputs.file_input("a.txt").error
    assert inputs.file_input("a.PLY").error == ""
    assert inputs.file_input("a.b.ply").name == "a.b"
