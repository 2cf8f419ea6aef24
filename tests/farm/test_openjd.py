# SPDX-License-Identifier: GPL-3.0-or-later
"""The job of Open Job Description, carried out by its own command line on several workers, one of which dies."""

import json
import pathlib
import shlex
import subprocess

import batches

ROOT = pathlib.Path(__file__).resolve().parents[2]
OPENJD = ROOT / "build/farm/bin/openjd"
TEMPLATE = ROOT / "build/stage/hybrid_mesh/farm/hybrid_mesh.openjd.yaml"


class Worker:
    """A machine that does some of a job's tasks, one after the other."""

    def __init__(self, batch, count, step, log, numbers=()):
        tasks = ["--tasks", json.dumps([{"Input": number} for number in numbers])] if numbers else []
        self._log = open(log, "w+", encoding="utf-8")
        self.process = subprocess.Popen(
            [
                OPENJD, "run", TEMPLATE, "--step", step, *tasks, "--no-run-dependencies", "-p", f"Batch={batch}", "-p", f"Inputs={count}",
                "-p", f"Command={shlex.join(batches.command_line())}", "-p", "Threads=1",
            ],
            stdout=self._log, stderr=subprocess.STDOUT,
        )  # fmt: skip

    def end(self):
        """Its exit code and what it said."""
        code = self.process.wait(timeout=1800)
        self._log.seek(0)
        with self._log:
            return code, self._log.read()


def test_a_batch_on_four_workers_of_which_one_is_killed(tmp_path, scans):
    good, bad, count = scans.good, scans.bad, scans.count
    batch = batches.write_batch(scans.folder, tmp_path / "farm")
    shares = [range(1 + worker, count + 1, batches.WORKERS) for worker in range(batches.WORKERS)]

    workers = [Worker(batch, count, "Remesh", tmp_path / f"worker{number}.log", share) for number, share in enumerate(shares)]
    # Its last task, so that it has done others.
    killed = batches.wait_until(lambda: batches.working_on(tmp_path / "farm") & {shares[0][-1]})
    batches.kill_with_children(workers[0].process.pid)
    logs = [worker.end() for worker in workers]
    assert logs[0][0] < 0 and [code for code, _ in logs[1:]] == [0] * (batches.WORKERS - 1), logs
    records = tmp_path / "farm" / "batch.tasks"
    assert {int(path.stem) for path in records.iterdir()} == set(range(1, count + 1)) - killed

    code, log = Worker(batch, count, "MergeReports", tmp_path / "early.log").end()
    assert code != 0 and log.count("no task has finished it") == 1
    before = {path.name: path.stat().st_mtime_ns for path in (tmp_path / "farm").iterdir() if path.suffix == ".hmesh"}
    logs.append(Worker(batch, count, "Remesh", tmp_path / "again.log", shares[0]).end())
    assert logs[-1][0] == 0
    assert {name: time for name, time in before.items() if (tmp_path / "farm" / name).stat().st_mtime_ns != time} == {}

    # Some inputs are bad, which is the job's to say and no task's.
    code, log = Worker(batch, count, "MergeReports", tmp_path / "merge.log").end()
    assert code != 0 and f"{count} inputs: {len(good)} done, {len(bad)} failed" in log
    assert [name for name in bad if f"/{name}." not in log] == []
    assert {name: times for name in good if (times := sum(batches.times_done(log, name) for _, log in logs)) != 1} == {}
    assert any("openjd_progress: " in log for _, log in logs)

    batches.check_merged(tmp_path / "farm", scans.alone, good, bad)


def test_the_template_is_valid():
    checked = subprocess.run([OPENJD, "check", TEMPLATE], capture_output=True, encoding="utf-8")
    assert checked.returncode == 0, checked.stdout + checked.stderr
