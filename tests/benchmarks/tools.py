# SPDX-License-Identifier: GPL-3.0-or-later
"""The remeshers that are measured. Each takes a model and returns a mesh of about the asked number of vertices, with its seconds and peak
memory, or raises Failure. Every one runs in a process of its own."""

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
STAGE = ROOT / "build/stage"
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
    stages: dict = field(default_factory=dict)  # name: seconds
    report: dict = field(default_factory=dict)


def run(command, environment=None):
    """Runs to the end and returns (exit code, output, peak memory in bytes) of the process and its children."""
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            [str(word) for word in command], stdout=output, stderr=subprocess.STDOUT, env={**os.environ, **(environment or {})}, cwd=ROOT
        )
        deadline = time.monotonic() + TIMEOUT_S
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() > deadline:
                process.kill()
                os.wait4(process.pid, 0)
                process.returncode = -9
                raise Failure(f"not done after {TIMEOUT_S} s")
            time.sleep(0.02)
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        return process.returncode, output.read().decode(errors="replace"), usage.ru_maxrss * 1024


def last_complaint(text):
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    telling = [line for line in lines if "error" in line.lower() or "warning" in line.lower()]
    return (telling or lines or ["no message"])[-1][:200]


def hybrid_mesh(native, model, vertices, options):
    """Our own, through its command line."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["/usr/bin/python3", "-m", "hybrid_mesh", "remesh", model.path, "--output", folder, "--vertices", vertices, "--export", "ply"]
        start = time.perf_counter()
        code, output, _ = run(command + options, {"PYTHONPATH": str(STAGE)})
        seconds = time.perf_counter() - start
        if code != 0:
            raise Failure(last_complaint(output))
        report = json.loads((Path(folder) / f"{model.path.stem}.report.json").read_text())
        mesh = native.read_mesh(Path(folder) / f"{model.path.stem}.ply")
    stages = dict(report["seconds"])
    stages.pop("total", None)
    return Outcome(mesh, seconds, report["peak_memory_bytes"], stages, report)


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


def through_arrays(model, command, target):
    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder) / "in.npz", Path(folder) / "out.npz"
        points, offsets, indices = model.triangles
        np.savez(source, points=points, offsets=offsets, indices=indices, has_boundary=model.boundary_loops > 0)
        code, output, memory = run([*command, source, result, target])
        if not result.exists():
            raise Failure(f"exit code {code}: {last_complaint(output)}")
        made = np.load(result)
        if not made["changed"]:
            raise Failure(f"left the mesh unchanged: {last_complaint(output)}")
        if len(made["points"]) == 0:
            raise Failure("made an empty mesh")
        return Outcome((made["points"], made["offsets"], made["indices"]), float(made["seconds"]), memory)


def quadriflow(model, vertices):
    blender = ["blender", "--background", "--factory-startup", "-noaudio", "--python-exit-code", "1", "--python"]
    command = [*blender, HERE / "quadriflow_in_blender.py", "--"]
    # It asks for faces; a quad mesh has as many as vertices, but for the Euler number.
    return with_target(lambda target: through_arrays(model, command, target), model, vertices, vertices - model.euler)


def instant_meshes(model, vertices):
    command = [instant_meshes_python(), HERE / "instant_meshes_run.py"]
    return with_target(lambda target: through_arrays(model, command, target), model, vertices, vertices)


def instant_meshes_python():
    """Of a virtual environment that has the module."""
    venv = ROOT / "build/venv-instant-meshes"
    if not (venv / "complete").exists():
        subprocess.run(["/usr/bin/python3", "-m", "venv", "--clear", venv], check=True)
        subprocess.run([venv / "bin/pip", "install", "--quiet", "pyinstantmeshes==1.0.0", "numpy"], check=True, stdout=sys.stderr)
        (venv / "complete").touch()
    return venv / "bin/python"


VERSUS = {"quadriflow": quadriflow, "instant-meshes": instant_meshes}
