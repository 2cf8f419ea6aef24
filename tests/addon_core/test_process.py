# SPDX-License-Identifier: GPL-3.0-or-later
import gc
import sys
import warnings

import pytest
from hybrid_mesh.core import process


def child(monkeypatch, lines):
    """Has a child do these lines of Python instead of a job."""
    monkeypatch.setattr(process, "worker_command", lambda needs_bpy=False: [sys.executable, "-c", f"import os, sys\nmark = {process.RESULT_MARK!r}\n{lines}"])


@pytest.mark.parametrize("end, words", [("sys.exit(3)", "code 3"), ("os.abort()", "SIGABRT")])
def test_an_answer_that_is_cut_off_is_none(monkeypatch, end, words):
    child(monkeypatch, f"print(mark + '{{\"report\": [1, 2', end='', flush=True)\n{end}")
    with pytest.raises(process.WorkerFailed, match=words):
        process.Processes().run({})


def test_a_process_that_cannot_be_started_is_a_failure(monkeypatch, tmp_path):
    monkeypatch.setattr(process, "worker_command", lambda needs_bpy=False: [str(tmp_path / "none")])
    with pytest.raises(process.WorkerFailed, match="started.*No such file"):
        process.Processes().run({})


def test_nothing_stays_open(monkeypatch):
    child(monkeypatch, "print('on the way', file=sys.stderr)\nprint(mark + '{}', flush=True)")
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        assert process.Processes().run({}) == {}
        gc.collect()
    assert [str(one.message) for one in seen] == []


def ended(job):
    return job.wait(30)


def test_a_child_as_a_job(monkeypatch):
    child(monkeypatch, "sys.stdin.readline()\nprint(mark + '{\"bytes\": 3}', flush=True)")
    cleaned = []
    job = process.ProcessJob({}, "encoding", lambda: cleaned.append(True))
    assert job.stage == "encoding" and ended(job) and job.done
    assert job.result() == job.result() == {"bytes": 3} and cleaned == [True]


def test_a_job_that_fails_says_why(monkeypatch):
    child(monkeypatch, "print(mark + '{\"error\": \"too few bytes\"}', flush=True)")
    cleaned = []
    job = process.ProcessJob({}, "encoding", lambda: cleaned.append(True))
    with pytest.raises(process.WorkerFailed, match="too few bytes"):
        job.result()
    assert cleaned == [True]


def test_a_job_ends_when_it_is_cancelled(monkeypatch):
    child(monkeypatch, "import time\ntime.sleep(600)")
    cleaned = []
    job = process.ProcessJob({}, "encoding", lambda: cleaned.append(True))
    assert not job.wait(0.2) and not job.done
    job.cancel()
    assert ended(job) and cleaned == [True]
    with pytest.raises(process.WorkerFailed, match="cancelled"):
        job.result()
