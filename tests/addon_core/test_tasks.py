# SPDX-License-Identifier: GPL-3.0-or-later
import time

import numpy
import pytest
from hybrid_mesh import _native
from hybrid_mesh.core.settings import RemeshSettings
from hybrid_mesh.core.tasks import Chain, Task, TaskRun

TRIANGLE = (numpy.eye(3), numpy.array([0, 3]), numpy.array([0, 1, 2], dtype=numpy.int32))


def task(name, **settings):
    return Task(name, lambda: _native.start_remesh(*TRIANGLE, RemeshSettings(**settings).native()), name.upper())


def test_tasks_run_one_after_another_and_keep_their_notes():
    run = TaskRun([task("a"), task("b")])
    run.wait()
    assert run.done and [(one.name, one.note) for one, _ in run.results] == [("a", "A"), ("b", "B")] and not run.errors
    assert run.progress == 1


def test_a_task_that_fails_leaves_the_others():
    run = TaskRun([task("a", vertices=2), task("b")])
    run.wait()
    assert [one.name for one, _ in run.results] == ["b"]
    assert run.errors[0][0].name == "a" and "fewer than" in run.errors[0][1]


def test_a_task_that_does_not_start_is_an_error():
    run = TaskRun([Task("a", lambda: 1 / 0)])
    run.wait()
    assert run.done and "ZeroDivisionError" in run.errors[0][1]


def test_a_failure_is_kept_with_all_that_it_says():
    problems = [{"kind": "odd_sides", "message": "a face has 5 sides", "points": numpy.zeros((1, 3)), "stroke": -1, "face": 3}]

    def start():
        raise _native.LayoutError("region 0: a face has 5 sides", problems)

    run = TaskRun([Task("a", start)])
    run.wait()
    assert run.errors == [(run.tasks[0], "region 0: a face has 5 sides")]
    assert run.failures[0][1].args[1] is problems


def test_cancel_ends_soon_and_starts_nothing_more(monkeypatch):
    monkeypatch.setenv("HYBRID_MESH_FAKE_SECONDS", "60")
    run = TaskRun([task("a"), task("b")])
    run.step()
    assert not run.done and "a" in run.status and 0 <= run.progress < 0.5
    began = time.monotonic()
    run.cancel()
    assert time.monotonic() - began < 0.5 and run.done and not run.results


def test_a_cancel_need_not_wait_for_work_that_does_not_look_up():
    class Deaf:
        """Native work that goes on for a while after it was cancelled."""

        progress, stage, done, cancelled = 0.5, "", False, False

        def cancel(self):
            self.cancelled = True

        def wait(self, timeout_s=None):
            pytest.fail("it is waited for")

        def result(self):
            pytest.fail("it is asked for a result")

    job = Deaf()
    run = TaskRun([Task("a", lambda: job), Task("b", lambda: pytest.fail("it starts another one"))])
    run.step()
    run.cancel(wait=False)
    run.step()
    assert job.cancelled and not run.done
    job.done = True
    run.step()
    assert run.done and not run.results and not run.failures


def test_an_interrupted_wait_cancels(monkeypatch):
    monkeypatch.setenv("HYBRID_MESH_FAKE_SECONDS", "60")
    run = TaskRun([task("a")])

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(_native.Job, "wait", lambda self, timeout_s=None: interrupt() if timeout_s else None)
    with pytest.raises(KeyboardInterrupt):
        run.wait()
    assert run.done


def started(name="a", **settings):
    return task(name, **settings).start()


def test_a_chain_is_two_jobs_as_one():
    given = []

    def go_on(result):
        given.append(result)
        return started()

    seen = [0.0]
    chain = Chain(started(), go_on, 0.25)
    while not chain.wait(0.01):
        seen.append(chain.progress)
    assert chain.done and len(given) == 1 and chain.progress == 1
    assert seen == sorted(seen) and chain.result() is not None and len(given) == 1
    run = TaskRun([Task("a", lambda: Chain(started(), lambda result: started()))])
    run.wait()
    assert [one.name for one, _ in run.results] == ["a"]


def test_either_job_of_a_chain_may_fail():
    first = Chain(started(vertices=2), lambda result: pytest.fail("it goes on without a result"))
    second = Chain(started(), lambda result: started(vertices=2))
    for chain in (first, second):
        with pytest.raises(_native.Error, match="fewer than"):
            chain.result()
        assert chain.done

    def refuse(result):
        raise ValueError("not this one")

    chain = Chain(started(), refuse)
    assert chain.wait()
    for _ in range(2):
        with pytest.raises(ValueError, match="not this one"):
            chain.result()


def test_a_chain_that_is_cancelled_does_not_go_on(monkeypatch):
    monkeypatch.setenv("HYBRID_MESH_FAKE_SECONDS", "60")
    run = TaskRun([Task("a", lambda: Chain(started(), lambda result: pytest.fail("it goes on after a cancel")))])
    run.step()
    began = time.monotonic()
    run.cancel()
    assert time.monotonic() - began < 0.5 and run.done and not run.results
