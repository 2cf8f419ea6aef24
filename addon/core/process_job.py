# SPDX-License-Identifier: GPL-3.0-or-later
"""Work of core/worker.py that is used as a native job is."""

import os
import tempfile
import threading

import numpy

from .process import Processes


class ProcessJob:
    """A job on a mesh in a process of its own: it can be ended at once, whatever it is at. Nobody knows how far it is.

    job: a job of core/worker.py, which also gets the mesh's `arrays`; mesh: (points, offsets, indices); stage: what is being done, for people.
    """

    progress = 0.0

    def __init__(self, job, mesh, stage):
        self.stage = stage
        self._processes = Processes()
        self._answer = self._error = None
        self._thread = threading.Thread(target=self._run, args=(job, tuple(mesh)), daemon=True)
        self._thread.start()

    @property
    def done(self):
        return not self._thread.is_alive()

    def cancel(self):
        self._processes.end()

    def wait(self, timeout_s=None):
        """Waits until it has ended or the time is over; returns `done`."""
        self._thread.join(timeout_s)
        return self.done

    def result(self):
        """Waits, then returns the answer, or raises what went wrong."""
        self.wait()
        if self._error is not None:
            raise self._error
        return self._answer

    def _run(self, job, mesh):
        try:
            with tempfile.TemporaryDirectory(prefix="hybrid_mesh_") as folder:
                path = os.path.join(folder, "mesh.npz")
                numpy.savez(path, **dict(zip(("points", "offsets", "indices"), mesh, strict=True)))
                self._answer = self._processes.run({**job, "arrays": path, "folder": folder})
        except Exception as error:  # Raised again by result(), on whichever thread asks for it.
            self._error = error
