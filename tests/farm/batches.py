# SPDX-License-Identifier: GPL-3.0-or-later
"""Batches of small scans, some of them bad, and machines that work on them and die."""

import csv
import math
import os
import pathlib
import signal
import subprocess
import sys
import time

INPUTS = int(os.environ.get("HYBRID_MESH_FARM_INPUTS", 8))  # a tenth of them, but at least two, are bad
WORKERS = 4
# What a small scan is done with in half a second.
OPTIONS = ("--base-quads", "min", "--levels", "2", "--effort", "quick", "--threads", "1", "--export", "ply")

_BAD = {
    "empty.ply": b"",
    "words.obj": b"this is no mesh\n",
    "points_alone.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n",
    "no_such_point.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
    "not_a_number.off": b"OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n",
    "cut_off.stl": b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
    "flat_line.obj": b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
    "far_too_many.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
    "wrong_kind.ply": b"ply\nformat ascii 1.0\nelement vertex x\nend_header\n",
    "half_a_header.ply": b"ply\nformat ascii 1.0\n",
}


def write_inputs(folder, count=INPUTS):
    """Scans of 200 to 400 vertices and bad files among them; returns the names of both, without their endings."""
    folder.mkdir(parents=True)
    bad = dict(list(_BAD.items())[: max(2, count // 10)])
    for name, content in bad.items():
        (folder / name).write_bytes(content)
    good = [f"scan{number:03}" for number in range(count - len(bad))]
    for number, name in enumerate(good):
        (folder / f"{name}.obj").write_text(_ellipsoid(11 + number % 4, 1 + number % 7 / 10, 1.1 + number % 5 / 10))
    return good, [name.rpartition(".")[0] for name in bad]


def _ellipsoid(rows, width, height):
    points, faces, columns = [(0, 0, height)], [], 2 * rows
    for row in range(1, rows):
        for column in range(columns):
            up, around = math.pi * row / rows, 2 * math.pi * column / columns
            points.append((width * math.sin(up) * math.cos(around), math.sin(up) * math.sin(around), height * math.cos(up)))
    points.append((0, 0, -height))
    last = len(points) - 1
    for column in range(columns):
        following = (column + 1) % columns
        faces.append((0, 1 + column, 1 + following))
        faces.append((last, last - columns + following, last - columns + column))
        for row in range(rows - 2):
            a, b = 1 + row * columns + column, 1 + row * columns + following
            faces += [(a, a + columns, b + columns), (a, b + columns, b)]
    return "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)


def command_line():
    """How this checkout's package is started."""
    return [sys.executable, "-m", "hybrid_mesh"]


def run(*arguments):
    return subprocess.run([*command_line(), *map(str, arguments)], capture_output=True, encoding="utf-8", timeout=1800)


def remesh_alone(folder, output):
    """The whole batch on one machine."""
    return run("remesh", folder, "--output", output, *OPTIONS, "--jobs", 2)


def write_batch(folder, output):
    made = run("remesh", folder, "--output", output, *OPTIONS, "--farm")
    assert made.returncode == 0, made.stderr
    return output / "batch.json"


def results(folder):
    """The bytes of what every good input has made."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix in {".hmesh", ".ply"} or path.name.endswith(".plan.json")}


def summary(folder):
    with open(folder / "summary.csv", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def check_merged(folder, alone, good, bad):
    """A batch that workers have done is what one machine has done."""
    assert results(folder) == results(alone)
    assert {name.partition(".")[0] for name in results(folder)} == set(good)
    measured = {"seconds", "peak_memory_bytes"}
    rows = [[{key: value for key, value in row.items() if key not in measured} for row in summary(place)] for place in (folder, alone)]
    assert rows[0] == rows[1]
    assert {row["name"] for row in rows[0] if row["status"] == "done"} == set(good)
    assert {row["name"] for row in rows[0] if row["status"] == "failed" and row["error"]} == set(bad)
    assert [name for name in os.listdir(folder) if name.startswith(".hybrid-mesh-")] == []


def times_done(log, name):
    """How often a line of a log says that an input was remeshed."""
    return sum(f"{name}.obj: " in line and " quads, " in line for line in log.splitlines())


def working_on(folder):
    """The numbers of the tasks that are at work: those whose outputs are being made."""
    made = set()
    for name in os.listdir(folder):
        if name.startswith(".hybrid-mesh-task"):
            made.add(int(name.removeprefix(".hybrid-mesh-task").partition("-")[0]))
    return made


def wait_until(condition, seconds=60 + 20 * INPUTS):
    """Of a busy machine: a task has taken five seconds there."""
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end, "it did not happen in time"
        time.sleep(0.005)
    return found


def kill_with_children(pid):
    """SIGKILL to a process and all that it has started, as a machine that goes off does."""
    os.kill(pid, signal.SIGSTOP)  # so that it starts no more
    for child in _children(pid):
        kill_with_children(child)
    os.kill(pid, signal.SIGKILL)


def _children(pid):
    try:
        return [int(child) for task in pathlib.Path(f"/proc/{pid}/task").iterdir() for child in (task / "children").read_text().split()]
    except FileNotFoundError:
        return []
