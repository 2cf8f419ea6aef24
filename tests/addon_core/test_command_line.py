# SPDX-License-Identifier: GPL-3.0-or-later
import csv
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import time

import pytest


def rows(command_line, folder="out"):
    with open(command_line.folder / folder / "summary.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def report(command_line, name, folder="out"):
    return json.loads((command_line.folder / folder / f"{name}.report.json").read_text(encoding="utf-8"))


def test_remesh_writes_hierarchy_report_and_summary(command_line):
    run = command_line.run("remesh", command_line.box("box.obj"), "--output", "out", "--vertices", 100)
    assert run.returncode == 0 and run.err == "" and "box.obj" in run.out
    assert command_line.outputs() == ["box.hmesh", "box.plan.json", "box.report.json", "summary.csv"]
    made = report(command_line, "box")
    assert made["settings"]["vertices"] == 100 and made["version"] and made["peak_memory_bytes"] > 0 and made["input"]["file"] == "box.obj"
    assert list(made["seconds"])[0] == "read" and list(made["seconds"])[-1] == "total"
    assert [row["status"] for row in rows(command_line)] == ["done"]


def test_exports(command_line):
    run = command_line.run("remesh", command_line.box("box.obj"), "--output", "out", "--export", "ply,obj", "--export-repaired")
    assert run.returncode == 0
    assert command_line.outputs() == [
        "box.hmesh", "box.obj", "box.plan.json", "box.ply", "box.repaired.obj", "box.repaired.ply", "box.report.json", "summary.csv",
    ]  # fmt: skip


def test_every_level_is_exported(command_line):
    command = ("remesh", command_line.box("box.obj"), "--output", "out", "--levels", 2, "--export-levels", "ply,obj")
    assert command_line.run(*command).returncode == 0
    levels = [f"box.N{level}.{form}" for level in range(3) for form in ("obj", "ply")]
    assert command_line.outputs() == sorted(["box.hmesh", "box.plan.json", "box.report.json", "summary.csv", *levels])
    assert "skipped" in command_line.run(*command, "--resume").out
    (command_line.folder / "out" / "box.N1.ply").unlink()
    assert "skipped" not in command_line.run(*command, "--resume").out
    assert command_line.outputs() == sorted(["box.hmesh", "box.plan.json", "box.report.json", "summary.csv", *levels])


def test_encode_and_decode(command_line):
    assert command_line.run("remesh", command_line.box("box.obj"), "--output", "out", "--levels", 3).returncode == 0
    run = command_line.run("encode", "out/box.hmesh", "box.stream.hmesh")
    size = (command_line.folder / "box.stream.hmesh").stat().st_size
    assert (run.returncode, run.err, run.out) == (0, "", f"box.stream.hmesh: {size:,} bytes\n")
    counts = {}
    for name, *options in (("all",), ("less", "--bytes", 20), ("level", "--level", 1), ("base", "--level", 0)):
        run = command_line.run("decode", "box.stream.hmesh", "--output", f"{name}.OBJ", *options)
        assert (run.returncode, run.err) == (0, "")
        counts[name] = (command_line.folder / f"{name}.OBJ").read_text().count("\nv ")
        assert "vertices" in run.out and "faces" in run.out
    assert counts["all"] > counts["less"] == counts["level"] > counts["base"]
    assert command_line.run("decode", "out/box.hmesh", "--output", "whole.ply").returncode == 0
    assert command_line.run("encode", "out/box.hmesh", "rough.hmesh", "--error", 0.1).returncode == 0
    assert (command_line.folder / "rough.hmesh").read_text() != (command_line.folder / "box.stream.hmesh").read_text()
    assert command_line.run("encode", "out/box.hmesh", "near.hmesh", "--source", "box.obj").returncode == 0
    assert command_line.run("info", "rough.hmesh").returncode == 0


def test_what_cannot_be_encoded_or_decoded_is_one_line(command_line):
    command_line.box("box.obj")
    assert command_line.run("remesh", "box.obj", "--output", "out").returncode == 0
    (command_line.folder / "nothing.hmesh").write_bytes(b"")
    for command, said in (
        (("encode", "missing.hmesh", "a.hmesh"), "missing.hmesh: "),
        (("encode", "nothing.hmesh", "a.hmesh"), "empty"),
        (("encode", "box.obj", "a.hmesh"), "box.obj: not a hierarchy"),
        (("encode", "out/box.hmesh", "a.hmesh", "--bytes", 5), "out/box.hmesh: the base alone"),
        (("decode", "nothing.hmesh", "--output", "a.ply"), "empty"),
        (("decode", "out/box.hmesh", "--output", "a.ply", "--bytes", 100), "no stream"),
    ):
        run = command_line.run(*command)
        assert run.returncode == 1 and said in run.err and run.err.count("\n") == 1 and "a.hmesh" not in run.out, command


def test_density_is_a_name(command_line):
    assert command_line.run("remesh", command_line.box("box.obj"), "--output", "out", "--density", "dense").returncode == 0
    assert report(command_line, "box")["settings"]["density"] == "dense"
    run = command_line.run("remesh", "box.obj", "--output", "out", "--density", "")
    assert run.returncode == 2 and "--density" in run.err
    text = " ".join(command_line.run("remesh", "--help").out.split())
    assert "--density NAME" in text and "4^(1 - 2 v)" in text


@pytest.mark.parametrize("option, values", [("topology", ("auto", "late", "base")), ("components", ("apart", "joined")), ("effort", ("normal", "quick", "thorough"))])
def test_a_choice_is_a_setting(command_line, option, values):
    for value in values:
        assert command_line.run("remesh", command_line.box("box.obj"), "--output", "out", f"--{option}", value).returncode == 0
        assert report(command_line, "box")["settings"].get(option, values[0]) == value


@pytest.mark.parametrize("value, reported", [("auto", "auto"), ("x", "x"), ("z", "z"), ("1,0,0,2.5", [1, 0, 0, 2.5]), ("none", None)])
def test_symmetry_is_a_setting(command_line, value, reported):
    command = ("remesh", command_line.box("box.obj"), "--output", "out", "--symmetry", value, "--symmetry-side", "average")
    assert command_line.run(*command).returncode == 0
    settings = report(command_line, "box")["settings"]
    assert settings.get("symmetry") == reported and settings.get("symmetry_side") == (reported and "average")
    assert "skipped" in command_line.run(*command, "--resume").out
    assert ("skipped" in command_line.run("remesh", "box.obj", "--output", "out", "--resume").out) == (value == "none")


@pytest.mark.parametrize("options, value", [((), "auto"), (("auto",), "auto"), (("none",), "none"), (("40",), 40), (("32.5",), 32.5)])
def test_sharp_edges_are_a_setting(command_line, options, value):
    chosen = ("--features", *options) if options else ()
    command = ("remesh", command_line.box("box.obj"), "--output", "out", *chosen)
    assert command_line.run(*command).returncode == 0
    assert report(command_line, "box")["settings"]["features"] == value
    stored = json.loads(json.loads(command_line.run("info", "out/box.hmesh").out)["metadata"])
    assert stored["settings"]["features"] == value
    assert "skipped" in command_line.run(*command, "--resume").out
    assert "skipped" not in command_line.run("remesh", "box.obj", "--output", "out", "--resume", "--features", "77").out


def test_a_plan_is_passed_on_and_known_to_a_resumed_run(command_line):
    first = command_line.run("remesh", command_line.box("box.obj"), "--output", "out")
    assert first.returncode == 0
    plan = json.loads((command_line.folder / "out" / "box.plan.json").read_text(encoding="utf-8"))
    plan["base"] = {"nodes": []}
    (command_line.folder / "mine.json").write_text(json.dumps(plan), encoding="utf-8")
    planned = ("remesh", "box.obj", "--output", "out", "--plan", "mine.json", "--resume")
    assert "skipped" not in command_line.run(*planned).out
    assert json.loads((command_line.folder / "out" / "box.plan.json").read_text(encoding="utf-8")) == plan
    assert "skipped" in command_line.run(*planned).out
    assert "plan" not in report(command_line, "box")["settings"]


def test_one_bad_input_leaves_the_others_done(command_line):
    names = [command_line.box(name) for name in ("a.obj", "crash.obj", "hang.obj", "refuse.obj", "Größe 猫.obj")]
    (command_line.folder / "empty.ply").write_bytes(b"")
    (command_line.folder / "folder.ply").mkdir()
    (command_line.folder / "notes.txt").write_text("x")
    names += ["empty.ply", "missing.ply", "folder.ply", "notes.txt"]
    run = command_line.run("remesh", *names, "--output", "out", "--timeout", 2, "--jobs", 3)
    assert run.returncode == 1
    lines = sorted(run.err.splitlines())
    bad = ["crash.obj", "empty.ply", "folder.ply", "hang.obj", "missing.ply", "notes.txt", "refuse.obj"]
    assert len(lines) == len(bad)
    for line, name in zip(lines, bad):
        assert line.startswith(f"hybrid-mesh: {name}: ") and line.count(name) == 1
    assert [row["name"] for row in rows(command_line)] == [os.path.splitext(name)[0] for name in names]
    assert [row["status"] for row in rows(command_line)] == ["done"] + 3 * ["failed"] + ["done"] + 4 * ["failed"]
    assert "timed out" in report(command_line, "hang")["error"] and "SIGABRT" in report(command_line, "crash")["error"]
    made = command_line.outputs()
    assert "Größe 猫.hmesh" in made and "a.hmesh" in made
    assert not [name for name in made if name.endswith(".hmesh") and name not in ("a.hmesh", "Größe 猫.hmesh")]
    assert not [name for name in made if name.startswith(".")]


def test_a_folder_of_meshes(command_line):
    scans = command_line.folder / "scans"
    (scans / "deep").mkdir(parents=True)
    for name in ("b.obj", "a.obj", "deep/c.obj"):
        command_line.box(f"scans/{name}")
    run = command_line.run("remesh", "scans", "--output", "scans/out")
    assert (run.returncode, run.err) == (0, "hybrid-mesh: scans: skipped, no mesh files: deep/\n")
    assert [row["input"] for row in rows(command_line, "scans/out")] == ["scans/a.obj", "scans/b.obj"]
    (scans / "notes.txt").write_text("x")
    again = command_line.run("remesh", "scans/", "scans/a.obj", "--output", "scans/out", "--resume")
    assert again.returncode == 0 and again.out.count("skipped") == 2 and again.err.count("\n") == 1 and "notes.txt" in again.err
    (scans / "refuse.obj").write_text("x")
    (scans / "scene.fbx").write_text("x")
    bad = command_line.run("remesh", "scans", "--output", "scans/out", "--resume")
    assert bad.returncode == 1 and bad.out.count("skipped") == 2
    assert [line.split(": ", 2)[1] for line in bad.err.splitlines()] == ["scans", "scans/refuse.obj", "scans/scene.fbx"] and "Blender" in bad.err
    empty = command_line.run("remesh", "scans/deep/..", "scans/out", "--output", "other")
    assert empty.returncode == 1 and "hybrid-mesh: scans/out: is a folder without a mesh file" in empty.err
    assert [row["status"] for row in rows(command_line, "other")] == ["done", "done", "failed", "failed", "failed"]


def test_inputs_of_one_name_get_names_of_their_own(command_line):
    for folder in ("x", "y"):
        (command_line.folder / folder).mkdir()
        command_line.box(f"{folder}/a.obj")
    (command_line.folder / "y" / "a.obj").write_text((command_line.folder / "y" / "a.obj").read_text().replace("v 0 0 0", "v 0 0 -1"))
    made = {}
    for order in (("x/a.obj", "y"), ("y/a.obj", "x/a.obj", "y")):
        run = command_line.run("remesh", *order, "--output", "out", "--export", "obj")
        assert (run.returncode, run.err) == (0, "") and "y/a.obj: another input has this name, its outputs are called a-2" in run.out
        assert {row["input"]: row["name"] for row in rows(command_line)} == {"x/a.obj": "a", "y/a.obj": "a-2"}
        files = {name: (command_line.folder / "out" / name).read_bytes() for name in ("a.obj", "a-2.obj", "a.hmesh", "a-2.hmesh")}
        assert not made or files == made
        made = files
    assert made["a.obj"] != made["a-2.obj"]
    assert command_line.run("remesh", "y", "x", "--output", "out", "--export", "obj", "--resume").out.count("done before") == 2


@pytest.mark.parametrize(
    "arguments, said",
    [
        ((), "COMMAND"),
        (("remesh",), "--output"),
        (("remesh", "box.obj"), "--output"),
        (("remesh", "--output", "out"), "INPUT"),
        (("unknown",), "unknown"),
        (("encode", "a"), "OUT.hmesh"),
        (("encode", "a", "b", "--bytes", "0"), "--bytes"),
        (("encode", "a", "b", "--error", "1"), "--error"),
        (("encode", "a", "b", "--error", "0.1", "--bytes", "100"), "--bytes"),
        (("encode", "a", "b", "--exact", "--source", "c.ply"), "--source"),
        (("decode", "a"), "--output"),
        (("decode", "a", "--output", "b.glb"), "'b.glb'"),
        (("decode", "a", "--output", "b.ply", "--level", "-1"), "--level"),
        (("bench",), "later"),
        (("remesh", "box.obj", "--output", "out", "--plan", "missing.json"), "missing.json"),
        (("remesh", "box.obj", "--output", "out", "--plan", "box.obj"), "JSON"),
        (("remesh", "box.obj", "--output", "out", "--symmetry", "w"), "--symmetry"),
        (("remesh", "box.obj", "--output", "out", "--symmetry", "0,0,0,1"), "--symmetry"),
        (("remesh", "box.obj", "--output", "out", "--symmetry-side", "left"), "--symmetry-side"),
        (("remesh", "box.obj", "--output", "out", "--vertices", "0"), "--vertices"),
        (("remesh", "box.obj", "--output", "out", "--vertices", "many"), "--vertices"),
        (("remesh", "box.obj", "--output", "out", "--vertices", "1e99"), "--vertices"),
        (("remesh", "box.obj", "--output", "out", "--levels", "-1"), "--levels"),
        (("remesh", "box.obj", "--output", "out", "--levels", "99"), "--levels"),
        (("remesh", "box.obj", "--output", "out", "--error", "0"), "--error"),
        (("remesh", "box.obj", "--output", "out", "--error", "nan"), "--error"),
        (("remesh", "box.obj", "--output", "out", "--faces", "hexagons"), "--faces"),
        (("remesh", "box.obj", "--output", "out", "--base-quads", "few"), "--base-quads"),
        (("remesh", "box.obj", "--output", "out", "--base-quads", "0"), "--base-quads"),
        (("remesh", "box.obj", "--output", "out", "--features", "some"), "--features: must be auto, none or an angle in degrees, not 'some'"),
        (("remesh", "box.obj", "--output", "out", "--features", ""), "--features"),
        (("remesh", "box.obj", "--output", "out", "--features", "nan"), "--features"),
        (("remesh", "box.obj", "--output", "out", "--features", "-40"), "--features"),
        (("remesh", "box.obj", "--output", "out", "--features", "180"), "--features"),
        (("remesh", "box.obj", "--output", "out", "--export", "fbx"), "--export"),
        (("remesh", "box.obj", "--output", "out", "--jobs", "0"), "--jobs"),
        (("remesh", "box.obj", "--output", "out", "--timeout", "-1"), "--timeout"),
        (("remesh", "box.obj", "--output", "out", "--drop-components", "1"), "--drop-components"),
        (("remesh", "box.obj", "--output", "out", "--vert", "5"), "--vert"),
        (("remesh", "box.obj", "--output", ".", "--export", "obj"), "overwritten"),
        (("remesh", "scene.blend", "--output", "out"), "Blender"),
        (("remesh", "box.obj", "scene.GLB", "--output", "out"), "scene.GLB: a .glb can be read inside Blender only"),
        (("remesh", "scene.gltf", "--output", "out"), "Blender"),
        (("remesh", "scene.fbx", "--output", "out"), "Blender"),
        (("remesh", "box.obj", "--output", "out", "--blend"), "Blender"),
        (("compare", "box.obj"), "B"),
        (("info",), "FILE"),
    ],
)
def test_wrong_arguments_get_one_line_and_start_nothing(command_line, arguments, said):
    command_line.box("box.obj")
    run = command_line.run(*arguments)
    assert run.returncode == 2 and run.out == ""
    assert len(run.err.splitlines()) == 1 and said in run.err
    assert command_line.outputs() is None and command_line.outputs(".") == ["box.obj"]


def test_help_and_version(command_line):
    assert "remesh" in command_line.run("--help").out
    options = command_line.run("remesh", "--help").out
    assert "--base-quads" in options and "--features auto|DEG|none" in options
    assert command_line.run("--version").returncode == 0


def test_without_the_compiled_module_it_says_so(command_line, tmp_path):
    staged = pathlib.Path(command_line.environment["PYTHONPATH"]) / "hybrid_mesh"
    shutil.copytree(staged, tmp_path / "bare" / "hybrid_mesh", ignore=shutil.ignore_patterns("_native.py"))
    command_line.environment["PYTHONPATH"] = str(tmp_path / "bare")
    run = command_line.run("remesh", command_line.box("box.obj"), "--output", "out")
    assert (run.returncode, run.out, run.err.count("\n")) == (1, "", 1) and "_native cannot be loaded" in run.err
    assert command_line.outputs() is None


def test_resume_does_only_what_is_not_done(command_line):
    for name in ("a.obj", "b.obj"):
        command_line.box(name)
    command = ("remesh", "a.obj", "b.obj", "--output", "out", "--levels", "1", "--resume")
    assert command_line.run(*command).returncode == 0
    assert command_line.run(*command, "--threads", 1).out.count("skipped") == 2
    (command_line.folder / "b.obj").write_text((command_line.folder / "b.obj").read_text().replace("v 0 0 0", "v 0 0 -1"))
    again = command_line.run(*command)
    assert "a.obj: done before" in again.out and "b.obj: done before" not in again.out
    assert [row["status"] for row in rows(command_line)] == ["skipped", "done"] and rows(command_line)[0]["vertices"] == "26"
    assert "skipped" not in command_line.run(*command, "--seed", 2).out
    (command_line.folder / "out" / "a.hmesh").unlink()
    assert "a.obj: done before" not in command_line.run(*command, "--seed", 2).out
    assert "skipped" not in command_line.run(*command, "--seed", 2, "--export", "ply").out
    (command_line.folder / "out" / "a.report.json").write_text("{")
    assert "a.obj: done before" not in command_line.run(*command, "--seed", 2).out


FAR, FEW = "far off (at 1, 2, 0.1)", "few, and fewer"


def test_a_poor_result_is_said_and_is_no_failure(command_line):
    for name in ("a.obj", "poor.obj", "b.obj"):
        command_line.box(name)
    run = command_line.run("remesh", "a.obj", "poor.obj", "b.obj", "--output", "out")
    assert run.returncode == 0
    assert run.err.splitlines() == [f"hybrid-mesh: poor.obj: poor: {text}" for text in (FAR, FEW)]
    assert run.out.splitlines()[-1] == "3 inputs: 3 done, 0 failed; 1 poor result"
    assert [(row["status"], row["verdict"], row["reasons"]) for row in rows(command_line)] == [
        ("done", "good", ""), ("done", "poor", f"{FAR}; {FEW}"), ("done", "good", ""),
    ]  # fmt: skip
    verdict = report(command_line, "poor")["verdict"]
    assert verdict["result"] == "poor" and [reason["what"] for reason in verdict["reasons"]] == ["hausdorff", "vertices"]
    info = json.loads(command_line.run("info", "out/poor.hmesh").out)
    assert info["verdict"] == verdict and json.loads(command_line.run("info", "out/a.hmesh").out)["verdict"]["result"] == "good"


def test_strict_makes_a_poor_result_a_failure_with_its_files(command_line):
    for name in ("a.obj", "poor.obj"):
        command_line.box(name)
    command = ("remesh", "a.obj", "poor.obj", "--output", "out", "--strict", "--export", "ply")
    assert "poor" in " ".join(command_line.run("remesh", "--help").out.split("--strict")[-1].split()[:20])
    for said in ("poor.obj: 26 vertices", "poor.obj: done before"):
        run = command_line.run(*command, "--resume", "--levels", 1)
        assert run.returncode == 1 and said in run.out
        assert run.err.splitlines() == [f"hybrid-mesh: poor.obj: poor: {text}" for text in (FAR, FEW)]
        assert run.out.splitlines()[-1] == "2 inputs: 1 done, 1 failed; 1 poor result"
        row = rows(command_line)[1]
        assert (row["status"], row["error"], row["vertices"], row["verdict"]) == ("failed", f"{FAR}; {FEW}", "26", "poor")
        assert {"poor.hmesh", "poor.plan.json", "poor.ply", "poor.report.json"} <= set(command_line.outputs())
    assert command_line.run("remesh", "a.obj", "--output", "out", "--strict").returncode == 0


def test_a_hierarchy_made_in_another_way_has_no_verdict(command_line):
    for metadata in ("", "no JSON", "[1]"):
        (command_line.folder / "made.hmesh").write_text(json.dumps([[0, 0, 0], [1, 1, 1], 2, metadata]))
        assert json.loads(command_line.run("info", "made.hmesh").out)["verdict"] is None


def test_a_failed_input_is_done_again(command_line):
    command_line.box("refuse.obj")
    for _ in range(2):
        run = command_line.run("remesh", "refuse.obj", "--output", "out", "--resume")
        assert run.returncode == 1 and "skipped" not in run.out


def test_the_same_command_gives_the_same_bytes(command_line):
    command_line.box("box.obj")
    for folder, threads in (("one", 1), ("two", 2)):
        assert command_line.run("remesh", "box.obj", "--output", folder, "--threads", threads, "--export", "ply").returncode == 0
    for name in ("box.hmesh", "box.ply"):
        assert (command_line.folder / "one" / name).read_bytes() == (command_line.folder / "two" / name).read_bytes()
    one, two = report(command_line, "box", "one"), report(command_line, "box", "two")
    assert {key for key in one if one[key] != two[key]} <= {"seconds", "peak_memory_bytes"}


def test_an_output_folder_that_cannot_be_made(command_line):
    command_line.box("box.obj")
    run = command_line.run("remesh", "box.obj", "--output", "box.obj/out")
    assert run.returncode == 1 and len(run.err.splitlines()) == 1 and "box.obj/out" in run.err


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes anywhere")
def test_an_output_folder_without_permission(command_line):
    command_line.box("box.obj")
    (command_line.folder / "out").mkdir(mode=0o500)
    run = command_line.run("remesh", "box.obj", "--output", "out")
    assert run.returncode == 1 and len(run.err.splitlines()) == 1 and "Permission" in run.err


def test_a_file_that_cannot_be_completed_is_not_there(command_line):
    command_line.box("box.obj")
    # As on a disk that fills: the first bytes are written, then no more.
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (600, 600))
    run = command_line.run("remesh", "box.obj", "--output", "out", "--levels", 3, "--export", "ply", preexec_fn=limit)
    assert run.returncode == 1 and len(run.err.splitlines()) == 1 and "box.obj" in run.err
    assert [name for name in command_line.outputs() if name not in ("box.report.json", "summary.csv")] == []


@pytest.mark.skipif(os.geteuid() != 0 or not shutil.which("mount"), reason="needs to mount a small disk")
def test_a_disk_that_fills(command_line):
    command_line.box("box.obj")
    out = command_line.folder / "out"
    out.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", str(out)], capture_output=True).returncode:
        pytest.skip("mounting is not allowed here")
    try:
        run = command_line.run("remesh", "box.obj", "--output", "out", "--levels", 4, "--export", "ply")
        assert run.returncode == 1 and "box.obj: " in run.err and "No space left on device" in run.err and ".hybrid-mesh-" not in run.err
        assert not [name for name in command_line.outputs() if name.endswith((".hmesh", ".ply")) or name.startswith(".")]
    finally:
        subprocess.run(["umount", str(out)], check=True)


def children_of(pid):
    found = []
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat", encoding="ascii", errors="replace") as file:
                    if int(file.read().rpartition(")")[2].split()[1]) == pid:
                        found.append(int(entry))
            except OSError:
                pass
    return found


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="needs /proc")
@pytest.mark.parametrize("kill", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_the_run_and_its_children_end_within_a_second(command_line, kill):
    for number in range(3):
        command_line.box(f"hang{number}.obj")
    process = command_line.start("remesh", *(f"hang{number}.obj" for number in range(3)), "--output", "out", "--jobs", 2)
    deadline = time.monotonic() + 20
    while len(children_of(process.pid)) < 2 and time.monotonic() < deadline:
        time.sleep(0.05)
    children = children_of(process.pid)
    assert len(children) == 2
    time.sleep(0.3)
    began = time.monotonic()
    process.send_signal(kill)
    out, err = process.communicate(timeout=10)
    while any(os.path.exists(f"/proc/{child}") and "Z" not in open(f"/proc/{child}/stat").read().split(")")[1][:3] for child in children):
        assert time.monotonic() - began < 1
        time.sleep(0.02)
    assert time.monotonic() - began < 1
    if kill != signal.SIGKILL:
        assert process.returncode == 130 and err == "hybrid-mesh: interrupted\n" and out == ""
        assert command_line.outputs() is None


def test_compare_and_info(command_line):
    command_line.box("box.obj")
    compared = command_line.run("compare", "box.obj", "box.obj")
    assert compared.returncode == 0 and json.loads(compared.out)["l2"] == 0
    for arguments, name in ((("compare", "box.obj", "missing.obj"), "missing.obj"), (("info", "box.obj"), "box.obj"), (("info", "none.hmesh"), "none.hmesh")):
        run = command_line.run(*arguments)
        assert run.returncode == 1 and len(run.err.splitlines()) == 1 and run.err.startswith(f"hybrid-mesh: {name}: ") and run.out == ""
    command_line.run("remesh", "box.obj", "--output", "out")
    checked = command_line.run("info", "out/box.hmesh", "--check")
    assert checked.returncode == 0 and json.loads(checked.out)["problems"] == []
    (command_line.folder / "flat.hmesh").write_text('[[0, 0, 0], [1, 1, 0], 2, ""]')
    flat = command_line.run("info", "flat.hmesh", "--check")
    assert flat.returncode == 1 and flat.err == "hybrid-mesh: flat.hmesh: the box is empty\n"


def test_a_reader_that_leaves_early_is_no_failure_to_speak_of(command_line):
    command_line.box("box.obj")
    process = command_line.start("compare", "box.obj", "box.obj")
    process.stdout.close()
    process.wait(20)
    assert "Traceback" not in process.stderr.read()
