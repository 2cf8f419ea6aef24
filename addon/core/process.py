# SPDX-License-Identifier: GPL-3.0-or-later
"""A process of its own for every piece of work: one that crashes, hangs or runs out of memory is one failure and no more.

The child is `worker_process.py`. It gets its job as one line of JSON on stdin, which then stays open so that the child sees its parent
die, and answers with one marked line on stdout (Blender writes there too). Before it there may be lines with another mark that say how far it is.
"""

import json
import os
import signal
import subprocess
import sys
import threading

RESULT_MARK = "HYBRID_MESH_RESULT "
PROGRESS_MARK = "HYBRID_MESH_PROGRESS "
SCRIPT = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "worker_process.py")


class WorkerFailed(ValueError):
    """The work failed; the message is one line for people."""


class WorkerKilled(WorkerFailed):
    """Someone else ended the work, a user or a system without memory: what it worked on may be good, and another try of it, too."""


class Processes:
    """The running children, so that all of them can be ended at once from any thread."""

    def __init__(self):
        self._lock = threading.Lock()
        self._running = set()
        self._ended = False

    def run(self, job, timeout=None, needs_bpy=False, progress=None):
        """Does a job in a child and returns its answer, a dictionary. Raises WorkerFailed. progress(fraction, stage) is told how far it is, where the job says so."""
        process = self._start(worker_command(needs_bpy))
        late = threading.Event()
        timer = None
        if timeout:
            timer = threading.Timer(timeout, lambda: (late.set(), process.kill()))
            timer.daemon = True
            timer.start()
        errors = []
        drain = threading.Thread(target=_read_all, args=(process.stderr, errors), daemon=True)
        drain.start()
        answer = None
        try:
            try:
                process.stdin.write(json.dumps(job) + "\n")
                process.stdin.flush()
            except OSError:
                pass  # The child is gone; how it ended says why.
            for line in process.stdout:
                if line.startswith(RESULT_MARK) and line.endswith("\n"):  # One that is cut off is no answer.
                    answer = json.loads(line[len(RESULT_MARK) :])
                elif progress and line.startswith(PROGRESS_MARK) and line.endswith("\n"):
                    progress(*json.loads(line[len(PROGRESS_MARK) :]))
            code = process.wait()
            drain.join(5)
        finally:
            if timer:
                timer.cancel()
            self._forget(process)
        if answer is None:
            if self.ended:
                raise WorkerFailed("cancelled")
            if late.is_set():
                raise WorkerFailed(f"timed out after {timeout:g} s")
            killed = os.name == "posix" and code in (-signal.SIGKILL, -signal.SIGTERM)
            raise (WorkerKilled if killed else WorkerFailed)(_how_it_ended(code, errors))
        if "error" in answer:
            raise WorkerFailed(answer["error"])
        return answer

    @property
    def ended(self):
        return self._ended

    def end(self):
        """Kills every child; later runs fail at once."""
        with self._lock:
            self._ended = True
            for process in self._running:
                process.kill()

    def _start(self, command):
        with self._lock:
            if self._ended:
                raise WorkerFailed("cancelled")
            # A session of its own: Ctrl-C reaches this process only, which then ends the children.
            try:
                process = subprocess.Popen(
                    command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", errors="replace",
                    start_new_session=os.name == "posix", env=_environment(),
                )  # fmt: skip
            except OSError as error:
                raise WorkerFailed(f"no process for it could be started ({error.strerror})") from error
            self._running.add(process)
            return process

    def _forget(self, process):
        with self._lock:
            self._running.discard(process)
        if process.poll() is None:
            process.kill()
            process.wait()
        for stream in (process.stdin, process.stdout):
            try:
                stream.close()
            except OSError:
                pass


class ProcessJob:
    """A child's work as a job, as native ones are, but without progress: for what would not end when it is told to, did it run here."""

    progress = 0.0

    def __init__(self, job, stage, cleanup=None):
        """job, answer: as Processes.run() has them; stage: what people read meanwhile; cleanup(): is called when the child has ended."""
        self.stage = stage
        self._processes, self._answer, self._error = Processes(), None, None
        self._thread = threading.Thread(target=self._work, args=(job, cleanup), daemon=True)
        self._thread.start()

    def _work(self, job, cleanup):
        try:
            self._answer = self._processes.run(job)
        except Exception as error:  # result() raises it.
            self._error = error
        finally:
            if cleanup is not None:
                cleanup()

    @property
    def done(self):
        return not self._thread.is_alive()

    def cancel(self):
        self._processes.end()

    def wait(self, timeout_s=None):
        self._thread.join(timeout_s)
        return self.done

    def result(self):
        self.wait()
        if self._error is not None:
            raise self._error
        return self._answer


def _read_all(stream, lines):
    with stream:
        lines.extend(stream)


def in_blender():
    """Whether this process is the Blender program itself (not Python with the bpy module)."""
    return bool(_blender_binary())


def bpy_available():
    """Whether work that needs bpy can be done from here."""
    if in_blender():
        return True
    import importlib.util

    return "bpy" in sys.modules or importlib.util.find_spec("bpy") is not None


def worker_command(needs_bpy=False):
    """The command line of a child. Python where that does, since it starts faster and takes less memory than Blender."""
    blender = _blender_binary()
    if not blender:
        return [sys.executable, SCRIPT]
    python = _python_of_blender()
    if python and not needs_bpy:
        return [python, SCRIPT]
    return [blender, "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python", SCRIPT]


def _blender_binary():
    bpy = sys.modules.get("bpy")
    return bpy.app.binary_path if bpy else ""


def _python_of_blender():
    # Not sys.executable: where Blender uses the system's Python that is the first python on PATH, whatever its version.
    name = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    for path in (os.path.join(sys.prefix, "bin", name), os.path.join(sys.prefix, "bin", "python.exe")):
        if os.access(path, os.X_OK):
            return path
    return None


def _environment():
    environment = dict(os.environ)
    environment["PYTHONUTF8"] = "1"
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    return environment


def _how_it_ended(code, errors):
    if code < 0:
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = f"signal {-code}"
        hint = "; perhaps out of memory" if name == "SIGKILL" else ""
        return f"the process that worked on it crashed ({name}{hint})"
    last = next((line.strip() for line in reversed(errors) if line.strip()), "")
    return f"the process that worked on it ended with code {code}" + (f": {last}" if last else "")
