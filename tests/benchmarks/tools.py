# SPDX-License-Identifier: GPL-3.0-or-later
"""The remeshers that are measured. Each takes a model and returns a mesh of about the asked number of vertices, with its seconds and peak
memory, or raises Failure. Every one runs in a process of its own."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
STAGE = ROOT / "build/stage"
BLENDER = ["blender", "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python"]
TIMEOUT_S = 1800
CLOSE_ENOUGH = 0.01  # of the number of vertices asked for; beyond it a tool that takes a target is run again with another


class Failure(Exception):
    """Why a tool made no mesh, in one line."""


@dataclass
class Model:
    name: str
    path: Path
    mesh: tuple  # points, offsets, indices, as read
    triangles: tuple  # the same, repaired
    euler: int
    boundary_loops: int


@dataclass
class Outcome:
    mesh: tuple
    seconds: float
    peak_memory_bytes: int
    cpu_seconds: float
    stages: dict = field(default_factory=dict)  # name: seconds
    report: dict = field(default_factory=dict)


class Ended(NamedTuple):
    """A process that has come to its end; figures include its children's."""

    code: int
    output: str
    peak_memory_bytes: int
    cpu_seconds: float


def run(command, environment=None, timeout_s=TIMEOUT_S):
    """Runs to the end, or raises Failure when the time is over: then the process and its children are ended."""
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            [str(word) for word in command],
            stdout=output, stderr=subprocess.STDOUT, env={**os.environ, **(environment or {})}, cwd=ROOT, start_new_session=True,
        )  # fmt: skip
        try:
            status, usage = wait(process, timeout_s)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            os.wait4(process.pid, 0)
            process.returncode = -signal.SIGKILL
            raise
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read().decode(errors="replace")
        return Ended(process.returncode, text, usage.ru_maxrss * 1024, usage.ru_utime + usage.ru_stime)


def wait(process, timeout_s):
    """(status, usage) of a process that has ended."""
    deadline = time.monotonic() + timeout_s
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            return status, usage
        if time.monotonic() > deadline:
            raise Failure(f"not done after {timeout_s:g} s")
        time.sleep(0.02)


def last_complaint(text):
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    telling = [line for line in lines if "error" in line.lower() or "warning" in line.lower()]
    return (telling or lines or ["no message"])[-1][:200]


def hybrid_mesh(native, model, vertices, options, timeout_s=TIMEOUT_S):
    """Our own, through its command line."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["/usr/bin/python3", "-m", "hybrid_mesh", "remesh", model.path, "--output", folder, "--vertices", vertices, "--export", "ply"]
        start = time.perf_counter()
        ended = run(command + options, {"PYTHONPATH": str(STAGE)}, timeout_s)
        seconds = time.perf_counter() - start
        if ended.code != 0:
            raise Failure(last_complaint(ended.output))
        report = json.loads((Path(folder) / f"{model.path.stem}.report.json").read_text())
        mesh = native.read_mesh(Path(folder) / f"{model.path.stem}.ply")
    stages = dict(report["seconds"])
    stages.pop("total", None)
    return Outcome(mesh, seconds, report["peak_memory_bytes"], ended.cpu_seconds, stages, report)


def with_target(tool, model, vertices, first_target):
    """Runs a tool that takes a target once, and once more with a corrected one if it missed; returns the outcome nearer to `vertices`."""
    outcomes, target = [], first_target
    for _ in range(2):
        outcomes.append(tool(target))
        made = len(outcomes[-1].mesh[0])
        if abs(made - vertices) <= CLOSE_ENOUGH * vertices:
            break
        target = max(1, round(target * vertices / made))
    return min(outcomes, key=lambda outcome: abs(len(outcome.mesh[0]) - vertices))


def through_arrays(model, command, target, sharp_angle=None, timeout_s=TIMEOUT_S):
    """Runs a script that takes arrays; NaN stands for no sharp angle."""
    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder) / "in.npz", Path(folder) / "out.npz"
        points, offsets, indices = model.triangles
        angle = float("nan") if sharp_angle is None else sharp_angle
        np.savez(source, points=points, offsets=offsets, indices=indices, has_boundary=model.boundary_loops > 0, sharp_angle=angle)
        ended = run([*command, source, result, target], timeout_s=timeout_s)
        if not result.exists():
            raise Failure(f"exit code {ended.code}: {last_complaint(ended.output)}")
        made = np.load(result)
        if not made["changed"]:
            raise Failure(f"left the mesh unchanged: {last_complaint(ended.output)}")
        if len(made["points"]) == 0:
            raise Failure("made an empty mesh")
        mesh = made["points"], made["offsets"], made["indices"]
        return Outcome(mesh, float(made["seconds"]), ended.peak_memory_bytes, float(made["cpu_seconds"]))


def quadriflow(model, vertices, **settings):
    command = [*BLENDER, HERE / "quadriflow_in_blender.py", "--"]
    # It asks for faces; a quad mesh has as many as vertices, but for the Euler number.
    return with_target(lambda target: through_arrays(model, command, target, **settings), model, vertices, vertices - model.euler)


def instant_meshes(model, vertices, **settings):
    command = [instant_meshes_python(), HERE / "instant_meshes_run.py"]
    return with_target(lambda target: through_arrays(model, command, target, **settings), model, vertices, vertices)


def instant_meshes_python():
    """Of a virtual environment that has the module."""
    venv = ROOT / "build/venv-instant-meshes"
    if not (venv / "complete").exists():
        subprocess.run(["/usr/bin/python3", "-m", "venv", "--clear", venv], check=True)
        subprocess.run([venv / "bin/pip", "install", "--quiet", "pyinstantmeshes==1.0.0", "numpy"], check=True, stdout=sys.stderr)
        (venv / "complete").touch()
    return venv / "bin/python"


VERSUS = {"quadriflow": quadriflow, "instant-meshes": instant_meshes}
