# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of native work done one after another."""

from dataclasses import dataclass
from typing import Any

from .native import explain


@dataclass
class Task:
    """One piece of native work for something that has a name. Holds no bpy data: those may go while the work runs."""

    name: str
    start: Any  # () -> native Job
    note: Any = None  # what the operator wants to know again when the result is there


class Chain:
    """Two native jobs as one, which is used as a job is.

    job: the first one; go_on(its result) starts the second one, or raises what then is the failure; share: of the progress that is the first one's.
    """

    def __init__(self, job, go_on, share=0.2):
        self._job, self._go_on, self._share = job, go_on, share
        self._second = self._cancelled = False
        self._error = None

    @property
    def done(self):
        if not self._second and not self._cancelled and self._error is None and self._job.done:
            try:
                self._job = self._go_on(self._job.result())
                self._second = True
            except Exception as error:  # result() raises it.
                self._error = error
        return self._error is not None or ((self._second or self._cancelled) and self._job.done)

    @property
    def progress(self):
        return self._share + (1 - self._share) * self._job.progress if self._second else self._share * self._job.progress

    @property
    def stage(self):
        return self._job.stage

    def cancel(self):
        self._cancelled = True
        self._job.cancel()

    def wait(self, timeout_s=None):
        """Waits until both have ended or the time is over; returns `done`. With a timeout it may return between the two."""
        while not self.done:
            self._job.wait(timeout_s)
            if timeout_s is not None:
                break
        return self.done

    def result(self):
        self.wait()
        if self._error is not None:
            raise self._error
        return self._job.result()


class TaskRun:
    """Tasks one after another, each over all cores."""

    def __init__(self, tasks):
        self.tasks = list(tasks)
        self.results = []  # (task, result)
        self.failures = []  # (task, exception)
        self._job = None
        self._next = 0
        self._cancelled = False

    @property
    def errors(self):
        """(task, one line for people) of the tasks that failed."""
        return [(task, explain(error)) for task, error in self.failures]

    @property
    def done(self):
        return self._job is None and self._next == len(self.tasks)

    @property
    def progress(self):
        finished = self._next - (self._job is not None)
        return (finished + (self._job.progress if self._job else 0)) / max(len(self.tasks), 1)

    @property
    def status(self):
        if self._job is None:
            return ""
        task = self.tasks[self._next - 1]
        return f"{task.name}: {self._job.stage}" if self._job.stage else task.name

    def step(self):
        """Starts the next task or takes a finished one's result; never waits."""
        if self._job is not None:
            if not self._job.done:
                return
            if not self._cancelled:
                self._take(self._job)
            self._job = None
        if self._next < len(self.tasks):
            task = self.tasks[self._next]
            self._next += 1
            try:
                self._job = task.start()
            except Exception as error:  # Reported by whoever runs the tasks.
                self.failures.append((task, error))

    def wait(self):
        """Does everything; Ctrl-C gets through."""
        try:
            while not self.done:
                self.step()
                if self._job is not None:
                    while not self._job.wait(0.1):
                        pass
        except BaseException:
            self.cancel()
            raise

    def cancel(self, wait=True):
        """Ends everything; there is no result of what is being done. Without waiting, native work may go on until it looks up: step() until all is done."""
        self._cancelled = True
        self._next = len(self.tasks)
        if self._job is not None:
            self._job.cancel()
            if wait:
                self._job.wait()
                self._job = None

    def _take(self, job):
        task = self.tasks[self._next - 1]
        try:
            self.results.append((task, job.result()))
        except Exception as error:  # Reported by whoever runs the tasks.
            self.failures.append((task, error))
