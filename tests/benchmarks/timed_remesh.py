# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes in this process and writes what it took as JSON: timed_remesh.py IN.npz OUT.json [REMESH OPTIONS]

Seconds and CPU seconds, of all threads, are of the remesh alone; its levels are looked at afterwards. CPU seconds of a stage are those between two looks at which the job said that it was at
that stage."""

import json
import sys
import time

import numpy as np
from hybrid_mesh import _native as native
from hybrid_mesh.core import cli, report
from quality import scaled_jacobians

LOOK_SECONDS = 0.005


def timed(start):
    """(job, seconds, CPU seconds, CPU seconds by stage) of a job that start() starts."""
    began, cpu_began = time.perf_counter(), time.process_time()
    stages, job, seen = {}, start(), cpu_began
    done = False
    while not done:
        done = job.wait(LOOK_SECONDS)
        now, stage = time.process_time(), job.stage or "start"
        stages[stage] = stages.get(stage, 0.0) + now - seen
        seen = now
    return job, time.perf_counter() - began, seen - cpu_began, stages


def described_levels(result, count):
    """Of each level its topology, and the shape of the quads with which something opened on it."""
    described = []
    for number in range(count):
        level = result.hierarchy.level(f"N{number}")
        mesh = [level[name] for name in ("points", "offsets", "indices")]
        opened = level["opened_level"] == number if number and "opened_level" in level else np.zeros(len(mesh[1]) - 1, bool)
        shapes = np.sort(scaled_jacobians(mesh)[opened])
        described.append({**native.topology(*mesh), "opened_quads": len(shapes), "opened_p05": float(shapes[len(shapes) // 20]) if len(shapes) else None})
    return described


def main(source, target, *options):
    settings = cli.remesh_settings(options).native()
    with np.load(source) as arrays:
        mesh = [arrays[name] for name in ("points", "offsets", "indices")]
    job, seconds, cpu_seconds, stages = timed(lambda: native.start_remesh(*mesh, settings))
    made = json.loads(job.result().report)
    memory = report.peak_memory_bytes()
    levels = described_levels(job.result(), len(made["levels"]))
    final = made["final"]
    measured = {
        "vertices": final["vertices"],
        "l2": final["l2"],
        "seconds": seconds,
        "cpu_seconds": cpu_seconds,
        "cpu_seconds_by_stage": stages,
        "peak_memory_bytes": memory,
        "verdict": made["verdict"],
        "levels": levels,
    }
    with open(target, "w", encoding="utf-8") as file:
        json.dump(measured, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
