# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the loops of a mesh in this process and writes what it took as JSON: timed_loops.py IN.npz OUT.json [ours|meshlib|noise LENGTH]

noise: closes what is shorter than LENGTH instead."""

import json
import sys
import time

import numpy as np
from hybrid_mesh.core import report


def ours(points, offsets, indices):
    from hybrid_mesh import _native as native

    start = time.perf_counter()
    loops = native.find_loops(points, offsets, indices)
    seconds = time.perf_counter() - start
    kinds = [loop["kind"] for loop in loops]
    return {
        "loops": len(loops),
        "handles": kinds.count("handle"),
        "length": sum(loop["length"] for loop in loops),
        "longest": max((loop["length"] for loop in loops), default=0.0),
        "seconds": seconds,
    }


def noise(points, offsets, indices, length):
    from hybrid_mesh import _native as native

    start = time.perf_counter()
    *closed, handles = native.close_noise(points, offsets, indices, float(length))
    seconds = time.perf_counter() - start
    return {"loops": handles, "left": native.topology(*closed)["genus"], "seconds": seconds}


def meshlib(points, offsets, indices):
    """Its basis has two loops for each handle."""
    from meshlib import mrmeshnumpy, mrmeshpy

    mesh = mrmeshnumpy.meshFromFacesVerts(np.asarray(indices).reshape(-1, 3), np.asarray(points))
    start = time.perf_counter()
    loops = mrmeshpy.detectBasisTunnels(mrmeshpy.MeshPart(mesh))
    seconds = time.perf_counter() - start

    def length_of(edge):
        a, b = mesh.orgPnt(edge), mesh.destPnt(edge)
        return ((a.x - b.x) ** 2 + (a.y - b.y) ** 2 + (a.z - b.z) ** 2) ** 0.5

    return {"loops": len(loops), "length": sum(length_of(edge) for loop in loops for edge in loop), "seconds": seconds}


def main(source, target, what="ours", *rest):
    with np.load(source) as arrays:
        mesh = [arrays[name] for name in ("points", "offsets", "indices")]
    cpu = time.process_time()
    measured = {"ours": ours, "meshlib": meshlib, "noise": noise}[what](*mesh, *rest)
    measured["cpu_seconds"] = time.process_time() - cpu
    measured["peak_memory_bytes"] = report.peak_memory_bytes()
    with open(target, "w", encoding="utf-8") as file:
        json.dump(measured, file)


if __name__ == "__main__":
    main(*sys.argv[1:])
