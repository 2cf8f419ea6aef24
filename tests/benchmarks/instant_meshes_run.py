# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs Instant Meshes on one mesh of triangles: instant_meshes_run.py IN.npz OUT.npz VERTICES

VERTICES is what the pure quad mesh is to have; the library's own target is a quarter of it, because it splits every face once."""

import sys
import time

import numpy as np
import pyinstantmeshes


def main(source, target, vertices):
    data = np.load(source)
    triangles = np.ascontiguousarray(data["indices"].reshape(-1, 3), np.int32)
    start = time.perf_counter()
    points, faces = pyinstantmeshes.remesh(
        np.ascontiguousarray(data["points"], np.float32),
        triangles,
        target_vertex_count=max(1, round(vertices / 4)),
        pure_quad=True,
        align_to_boundaries=bool(int(data["has_boundary"])) if "has_boundary" in data else False,
        deterministic=True,
    )
    seconds = time.perf_counter() - start
    faces = np.asarray(faces)
    np.savez(
        target,
        points=np.asarray(points, np.float64),
        offsets=np.arange(len(faces) + 1, dtype=np.int64) * faces.shape[1],
        indices=faces.astype(np.int32).ravel(),
        seconds=seconds,
        changed=True,
    )


main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
