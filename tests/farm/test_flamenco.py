# SPDX-License-Identifier: GPL-3.0-or-later
"""The job type of Flamenco: its script, run by the JavaScript engine that Flamenco's manager has, and the commands that it emits, carried out by workers of which one dies."""

import collections
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import threading
import time

import batches
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "build/stage/hybrid_mesh/farm/hybrid_mesh.js"
SOURCE = pathlib.Path(__file__).parent / "flamenco_manager"

pytestmark = pytest.mark.skipif(shutil.which("go") is None, reason="needs Go, which scripts/install-packages @farm installs")


@pytest.fixture(scope="module")
def manager():
    program = ROOT / "build/farm/flamenco_manager"
    built = subprocess.run(["go", "build", "-o", program, "."], cwd=SOURCE, capture_output=True, encoding="utf-8")
    assert built.returncode == 0, built.stderr

    def compile_job(folder, **settings):
        path = folder / "settings.json"
        path.write_text(json.dumps(settings))
        return subprocess.run([program, SCRIPT, path], capture_output=True, encoding="utf-8")

    return compile_job


class Farm:
    """Workers that take tasks as Flamenco's do: one whose dependencies are completed, and again one whose worker was lost."""

    def __init__(self, tasks):
        self.tasks = {task["name"]: task for task in tasks}
        self.status = dict.fromkeys(self.tasks, "queued")
        self.starts, self.logs, self.processes = collections.Counter(), collections.defaultdict(str), {}
        self.lock = threading.Lock()

    def run(self, workers=batches.WORKERS):
        threads = [threading.Thread(target=self._work) for _ in range(workers)]
        for thread in threads:
            thread.start()
        return threads

    def _work(self):
        while True:
            with self.lock:
                waiting = [name for name, status in self.status.items() if status in ("queued", "active")]
                ready = [name for name in waiting if self.status[name] == "queued" and all(self.status[other] == "completed" for other in self.tasks[name]["dependencies"])]
                if ready:
                    self.status[ready[0]] = "active"
            if not waiting:
                return
            if ready:
                self._carry_out(ready[0])
            else:
                time.sleep(0.01)

    def _carry_out(self, name):
        self.starts[name] += 1
        code = 0
        for command in self.tasks[name]["commands"]:
            assert command["name"] == "exec"
            arguments = [command["parameters"]["exe"], *command["parameters"]["args"]]
            process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8")
            with self.lock:
                self.processes[name] = process
            self.logs[name] += process.communicate()[0]
            code = process.returncode
            if code != 0:
                break
        with self.lock:
            self.status[name] = "completed" if code == 0 else "queued" if code < 0 and self.starts[name] < 3 else "failed"


def test_a_batch_on_four_workers_of_which_one_is_killed(tmp_path, scans, manager):
    batch = batches.write_batch(scans.folder, tmp_path / "farm")
    program = tmp_path / "hybrid-mesh"
    program.write_text(f"#!/bin/sh\nexec {shlex.join(batches.command_line())} \"$@\"\n")
    program.chmod(0o755)
    names = json.loads(batch.read_text())["names"]
    compiled = manager(tmp_path, batch=str(batch), names="\n".join(names), launcher="program", program=str(program), threads=1)
    assert compiled.returncode == 0, compiled.stderr
    tasks = json.loads(compiled.stdout)["tasks"]
    assert [task["name"] for task in tasks] == [f"remesh {name}" for name in names] + ["merge reports"]

    farm = Farm(tasks)
    threads = farm.run()
    number = batches.wait_until(lambda: batches.working_on(tmp_path / "farm") - {1, 2})
    killed = f"remesh {names[min(number) - 1]}"
    batches.kill_with_children(farm.processes[killed].pid)
    for thread in threads:
        thread.join(1800)
    # Some inputs are bad: the merge says so, and no task before it.
    assert {name for name, status in farm.status.items() if status != "completed"} == {"merge reports"}
    assert {name for name, starts in farm.starts.items() if starts != 1} == {killed}
    log = farm.logs["merge reports"]
    assert f"{scans.count} inputs: {len(scans.good)} done, {len(scans.bad)} failed" in log and [name for name in scans.bad if f"/{name}." not in log] == []
    assert {name: times for name in scans.good if (times := batches.times_done(farm.logs[f"remesh {name}"], name)) != 1} == {}
    batches.check_merged(tmp_path / "farm", scans.alone, scans.good, scans.bad)


def test_blender_is_started_as_its_version_takes_it(tmp_path, manager):
    made = {}
    for launcher in ("blender --command", "blender --addons"):
        compiled = manager(tmp_path, batch="/b/batch.json", names="a\nb", launcher=launcher)
        made[launcher] = [(task["type"], *task["commands"][0]["parameters"].values()) for task in json.loads(compiled.stdout)["tasks"]]
    for launcher, rest in (("blender --command", 2), ("blender --addons", 8)):
        for kind, *parameters in made[launcher]:
            assert kind == "blender" and "{blender}" in parameters
        arguments = next(value for value in made[launcher][1] if isinstance(value, list))
        assert arguments[rest - 1] in ("hybrid_mesh", "--") and arguments[rest:] == ["task", "--progress", "lines", "/b/batch.json", "2"]


def test_names_are_read_where_the_job_is_submitted(tmp_path, scans, manager):
    """Flamenco's add-on evaluates the expression of a setting with these names; the manager reads no files."""
    batch = batches.write_batch(scans.folder, tmp_path / "farm")
    settings = json.loads(manager(tmp_path, batch=str(batch), names="a").stdout)["type"]["settings"]
    expression = next(entry["eval"] for entry in settings if entry["key"] == "names")
    submitted = type("Settings", (), {"batch": str(batch)})
    names = eval(expression, {}, {"Path": pathlib.Path, "abspath": os.path.abspath, "settings": submitted})
    assert names.split("\n") == json.loads(batch.read_text())["names"]


@pytest.mark.parametrize("wrong, said", [({"names": "\n"}, "no inputs"), ({"launcher": "ship"}, "no launcher 'ship'")])
def test_what_makes_no_job_is_said(tmp_path, manager, wrong, said):
    compiled = manager(tmp_path, **{"batch": "/b/batch.json", "names": "a", **wrong})
    assert compiled.returncode != 0 and said in compiled.stderr
