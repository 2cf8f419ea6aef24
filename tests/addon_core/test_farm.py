# SPDX-License-Identifier: GPL-3.0-or-later
"""Batches whose inputs are done one by one, wherever and however often somebody starts a task."""

import csv
import json
import os
import pty
import shutil
import signal
import time

import pytest


def rows(command_line, folder="out"):
    with open(command_line.folder / folder / "summary.csv", encoding="utf-8", newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


@pytest.fixture
def batch(command_line):
    """Four inputs, of which the third is bad and the fourth has the name of the first."""
    (command_line.folder / "more").mkdir()
    for name in ("a.obj", "b.obj", "refuse.obj", "more/a.obj"):
        command_line.box(name)
    made = command_line.run("remesh", "a.obj", "b.obj", "refuse.obj", "more/a.obj", "--output", "out", "--levels", 1, "--export", "ply", "--farm")
    assert made.returncode == 0 and "4 inputs" in made.out and command_line.outputs() == ["batch.json", "batch.tasks"]
    return "out/batch.json"


def test_tasks_and_a_merge_are_a_batch(command_line, batch):
    for number in (3, 1, 4, 2):
        assert command_line.run("task", batch, number).returncode == 0
    merged = command_line.run("merge-reports", batch)
    assert merged.returncode == 1 and merged.out.splitlines()[-1] == "4 inputs: 3 done, 1 failed; 0 poor results"
    assert merged.err.splitlines() == ["hybrid-mesh: refuse.obj: no faces"]
    command_line.run("remesh", "a.obj", "b.obj", "refuse.obj", "more/a.obj", "--output", "alone", "--levels", 1, "--export", "ply")
    assert set(command_line.outputs()) - set(command_line.outputs("alone")) == {"batch.json", "batch.tasks"}
    for name in command_line.outputs("alone"):
        if not name.endswith((".report.json", ".csv")):
            assert (command_line.folder / "out" / name).read_bytes() == (command_line.folder / "alone" / name).read_bytes()
    measured = {"seconds", "peak_memory_bytes"}
    made, alone = ([{key: row[key] for key in row if key not in measured} for row in rows(command_line, folder).values()] for folder in ("out", "alone"))
    assert made == alone and {row["name"] for row in made} == {"a", "b", "refuse", "a-2"}


def test_a_task_is_done_once(command_line, batch):
    for number, said in ((1, "a.obj: done before"), (3, "refuse.obj: done before")):
        first, stamp = command_line.run("task", batch, number), os.stat(command_line.folder / f"out/batch.tasks/{number}.json").st_mtime_ns
        assert "before" not in first.out
        again = command_line.run("task", batch, number)
        assert again.returncode == 0 and said in again.out and os.stat(command_line.folder / f"out/batch.tasks/{number}.json").st_mtime_ns == stamp


def test_what_a_dead_worker_has_completed_is_kept_and_what_it_left_is_removed(command_line, batch):
    assert command_line.run("task", batch, 1).returncode == 0
    stamp = os.stat(command_line.folder / "out/a.hmesh").st_mtime_ns
    # It died after its outputs were in place, and another one before.
    (command_line.folder / "out/batch.tasks/1.json").unlink()
    for number in (1, 11):
        (command_line.folder / f"out/.hybrid-mesh-task{number}-x").mkdir()
    assert "done before" in command_line.run("task", batch, 1).out
    assert os.stat(command_line.folder / "out/a.hmesh").st_mtime_ns == stamp
    assert [name for name in command_line.outputs() if name.startswith(".")] == [".hybrid-mesh-task11-x"]
    assert json.loads((command_line.folder / "out/batch.tasks/1.json").read_text())["row"]["status"] == "done"


def test_a_task_that_is_missing_has_failed(command_line, batch):
    command_line.run("task", batch, 2)
    merged = command_line.run("merge-reports", batch)
    assert merged.returncode == 1 and merged.out.splitlines()[-1].startswith("4 inputs: 1 done, 3 failed")
    assert sum("no task has finished it" in line for line in merged.err.splitlines()) == 3


def test_an_earlier_batch_in_the_folder_does_not_count(command_line, batch):
    command_line.run("task", batch, 2)
    command_line.run("remesh", "a.obj", "b.obj", "--output", "out", "--levels", 2, "--farm")
    assert command_line.run("merge-reports", batch).out.splitlines()[-1].startswith("2 inputs: 0 done, 2 failed")
    assert "before" not in command_line.run("task", batch, 2).out
    assert rows(command_line)["b"]["status"] == "failed" and command_line.run("merge-reports", batch).returncode == 1
    assert rows(command_line)["b"]["levels"] == "3"


def test_a_worker_that_is_killed_leaves_the_task_to_another(command_line):
    command_line.box("hang.obj")
    command_line.run("remesh", "hang.obj", "--output", "out", "--farm")
    task = command_line.start("task", "out/batch.json", 1)
    children = f"/proc/{task.pid}/task/{task.pid}/children"
    end = time.monotonic() + 20
    while not (child := open(children).read().split()) and time.monotonic() < end:
        time.sleep(0.01)
    # The process that works on it alone: what a system without memory does.
    os.kill(int(child[0]), signal.SIGKILL)
    _, said = task.communicate(timeout=20)
    assert task.returncode == 1 and "SIGKILL" in said
    assert command_line.outputs() == ["batch.json", "batch.tasks"] and os.listdir(command_line.folder / "out/batch.tasks") == []


def test_a_machine_that_cannot_work_takes_no_input_for_bad(command_line, batch):
    stage = command_line.folder / "stage"
    shutil.copytree(command_line.environment["PYTHONPATH"], stage)
    (stage / "hybrid_mesh/_native.py").unlink()
    command_line.environment["PYTHONPATH"] = str(stage)
    run = command_line.run("task", batch, 1)
    assert run.returncode == 1 and "_native" in run.err and command_line.outputs() == ["batch.json", "batch.tasks"]


@pytest.mark.parametrize("change", [lambda content: content["inputs"][0].update(file="../scene.blend", object="Cube"), lambda content: content["outputs"].update(blend=True)])
def test_a_machine_without_blender_takes_no_scene_for_bad(command_line, batch, change):
    content = json.loads((command_line.folder / batch).read_text())
    change(content)
    (command_line.folder / batch).write_text(json.dumps(content))
    (command_line.folder / "scene.blend").write_bytes(b"BLENDER")
    run = command_line.run("task", batch, 1)
    assert run.returncode == 1 and run.err == "hybrid-mesh: a.obj" + (": Cube" if content["inputs"][0]["object"] else "") + ": input 1 needs Blender; this is Python without Blender\n"
    assert command_line.outputs() == ["batch.json", "batch.tasks"] and os.listdir(command_line.folder / "out/batch.tasks") == []


def test_the_folder_may_be_elsewhere_on_another_machine(command_line):
    shared = command_line.folder / "shared"
    (shared / "scans").mkdir(parents=True)
    command_line.box("shared/scans/a.obj")
    command_line.run("remesh", "shared/scans", "--output", "shared/out", "--farm")
    shared.rename(command_line.folder / "mounted")
    run = command_line.run("task", "mounted/out/batch.json", 1)
    assert run.returncode == 0 and "shared/scans/a.obj: " in run.out and "a.hmesh" in command_line.outputs("mounted/out")


def test_what_is_no_batch_is_said(command_line, batch):
    content = json.loads((command_line.folder / batch).read_text())
    for name, changed, said in (
        ("other", {**content, "format": "x"}, "is not the file of a batch"), ("version", {**content, "version": "9.9"}, "9.9"), ("cut", {**content, "names": []}, "no whole file"),
        ("setting", {**content, "settings": {"colour": 1}}, "colour"), ("list", [], "is not the file of a batch"),
    ):  # fmt: skip
        (command_line.folder / f"{name}.json").write_text(json.dumps(changed))
        for command in (("task", f"{name}.json", 1), ("merge-reports", f"{name}.json")):
            run = command_line.run(*command)
            assert run.returncode == 2 and said in run.err and f"{name}.json: " in run.err
    assert command_line.run("task", "missing.json", 1).returncode == 2
    run = command_line.run("task", batch, 5)
    assert run.returncode == 2 and "no input 5" in run.err


def test_progress_in_lines_and_for_a_scheduler(command_line, batch):
    command_line.environment["HYBRID_MESH_FAKE_SECONDS"] = "0.8"
    assert [line for line in command_line.run("task", batch, 1, "--progress", "openjd").out.splitlines() if line == "openjd_status: waiting"]
    lines = command_line.run("task", batch, 2, "--progress", "lines").out.splitlines()
    assert [line.split(" %")[0].rpartition(" ")[0] for line in lines if "waiting" in line][:1] == ["b.obj:"]
    assert "openjd" not in "".join(lines)


def test_progress_on_a_terminal(command_line):
    command_line.environment["HYBRID_MESH_FAKE_SECONDS"] = "0.8"
    for name in ("a.obj", "b.obj"):
        command_line.box(name)
    here, terminal = pty.openpty()
    command = command_line.start("remesh", "a.obj", "b.obj", "--output", "out", pass_fds=(terminal,), preexec_fn=lambda: os.dup2(terminal, 2))
    out, _ = command.communicate(timeout=60)
    os.close(terminal)
    said = b""
    try:
        while piece := os.read(here, 4096):
            said += piece
    except OSError:
        pass  # what Linux says at the end of a terminal
    assert b"\r0/2 done; a.obj " in said and b"\r1/2 done; b.obj " in said and b"% (waiting)" in said
    assert [line.split(": ")[0] for line in out.splitlines()] == ["[1/2] a.obj", "[2/2] b.obj", "2 inputs"]
