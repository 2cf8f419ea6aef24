# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs Instant Meshes on one mesh of triangles: instant_meshes_run.py IN.npz OUT.npz VERTICES

VERTICES is what the pure quad mesh is to have; the library's own target is a quarter of it, because it splits every face once. It is
driven through files: what its remesh() returns has been read back as triangles. IN's sharp_angle, if it is a number of degrees, is the crease angle; directions are then smoothed
extrinsically, as the program does unless told otherwise and the module does not, because that aligns them with creases."""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyinstantmeshes


def write_obj(path, points, triangles):
    with open(path, "w") as file:
        np.savetxt(file, points, "v %.9g %.9g %.9g")
        np.savetxt(file, triangles + 1, "f %d %d %d")


def read_obj(path):
    points, offsets, indices = [], [0], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            indices += [int(word.split("/")[0]) - 1 for word in words[1:]]
            offsets.append(len(indices))
    return np.array(points), np.array(offsets, np.int64), np.array(indices, np.int32)


def main(source, target, vertices):
    data = np.load(source)
    with tempfile.TemporaryDirectory() as folder:
        original, remesh = Path(folder) / "in.obj", Path(folder) / "out.obj"
        write_obj(original, data["points"], data["indices"].reshape(-1, 3))
        sharp = not np.isnan(data["sharp_angle"])
        start, cpu_start = time.perf_counter(), time.process_time()
        pyinstantmeshes.remesh_file(
            str(original),
            str(remesh),
            target_vertex_count=max(1, round(vertices / 4)),
            crease_angle=float(data["sharp_angle"]) if sharp else -1.0,
            extrinsic=sharp,
            pure_quad=True,
            align_to_boundaries=bool(data["has_boundary"]),
            deterministic=True,
        )
        seconds, cpu_seconds = time.perf_counter() - start, time.process_time() - cpu_start
        points, offsets, indices = read_obj(remesh)
    np.savez(target, points=points, offsets=offsets, indices=indices, seconds=seconds, cpu_seconds=cpu_seconds, changed=True)


main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
