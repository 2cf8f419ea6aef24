# SPDX-License-Identifier: GPL-3.0-or-later
"""Decimates a mesh of triangles by quadrics: decimation_run.py IN.npz OUT.npz TRIANGLES [TRIANGLES...]

IN has `points`, `faces` and `bits`; OUT has points and faces for every target, with its number behind. For every target and number of bits it also has the
bytes of meshoptimizer's vertex and index codecs behind one another, compressed by zstd at its best, as `meshoptimizer TARGET BITS`."""

import sys

import fast_simplification
import meshoptimizer
import numpy as np
import zstandard


def meshoptimizer_bytes(points, faces, bits):
    """Of positions in as many steps along the longest side of their box as Draco has of them."""
    low = points.min(0)
    steps = np.zeros((len(points), 4), np.uint16)
    steps[:, :3] = np.rint((points - low) / (points.max(0) - low).max() * (2**bits - 1))
    indices, vertices = np.zeros(faces.size, np.uint32), np.zeros_like(steps)
    meshoptimizer.optimize_vertex_cache(indices, faces.astype(np.uint32).ravel(), faces.size, len(points))
    count = meshoptimizer.optimize_vertex_fetch(vertices, indices, steps, faces.size, len(points), 8)
    coded = meshoptimizer.encode_vertex_buffer(vertices, count, 8) + meshoptimizer.encode_index_buffer(indices, faces.size, count)
    return len(zstandard.ZstdCompressor(22).compress(coded))


def decimated(points, faces, target):
    """By the least greedy way that ends at the target."""
    for greed in range(1, 8):
        made = fast_simplification.simplify(points, faces, target_count=target, agg=greed)
        if len(made[1]) <= 1.02 * target:
            break
    return np.asarray(made[0], float), np.asarray(made[1], np.int32)


def main(source, result, targets):
    data = np.load(source)
    made = {}
    for target in targets:
        points, faces = decimated(data["points"], data["faces"], target)
        made[f"points {target}"], made[f"faces {target}"] = points, faces
        for bits in data["bits"]:
            made[f"meshoptimizer {target} {bits}"] = meshoptimizer_bytes(points, faces, bits)
    np.savez(result, **made)


main(sys.argv[1], sys.argv[2], [int(word) for word in sys.argv[3:]])
