# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of bytes against distance: of our streams, and of decimated meshes in other codecs."""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import tools

SAMPLES = 100000  # of a distance, in either direction
BITS = range(8, 14)
RUNG = 2**0.5  # between the numbers of triangles of decimations
LEAST_TRIANGLES = 180
CLOSE = 1 / 256  # of a number of bytes: within it, a prefix is found


def distance(native, reference, mesh):
    return native.compare(*reference, *mesh[:3], SAMPLES)["l2"]


class Prefixes:
    """The distances of a stream's prefixes to the scan."""

    def __init__(self, native, stream, reference):
        self.native, self.stream, self.reference = native, stream, reference
        self.whole = stream.stat().st_size
        self.known = {}  # bytes: distance

    def distance(self, size):
        if size not in self.known:
            try:
                mesh = self.native.load_hierarchy(self.stream, most_bytes=size).final_mesh()
                self.known[size] = distance(self.native, self.reference, (mesh["points"], mesh["offsets"], mesh["indices"]))
            except self.native.CorruptStream:  # it ends before its base does
                self.known[size] = float("inf")
        return self.known[size]

    def shortest(self, error):
        """Bytes of the shortest prefix that is as near as that, as if distances fell all along the stream; None if the whole of it is not."""
        if self.distance(self.whole) > error:
            return None
        enough = min(size for size, found in self.known.items() if found <= error)
        short = max((size for size, found in self.known.items() if found > error and size < enough), default=32)
        while enough - short > 1 + enough * CLOSE:
            size = round((short * enough) ** 0.5)
            size = min(max(size, short + 1), enough - 1)
            if self.distance(size) <= error:
                enough = size
            else:
                short = size
        return enough


def venv_python():
    """Of a virtual environment with the modules of decimation_run.py."""
    venv = tools.ROOT / "build/venv-decimation"
    if not (venv / "complete").exists():
        subprocess.run(["/usr/bin/python3", "-m", "venv", "--clear", venv], check=True)
        modules = ["fast-simplification==0.2.0", "meshoptimizer==0.2.30a0", "zstandard==0.25.0", "numpy"]
        subprocess.run([venv / "bin/pip", "install", "--quiet", *modules], check=True, stdout=sys.stderr)
        (venv / "complete").touch()
    return venv / "bin/python"


def draco(mesh_file, bits, folder):
    """(bytes, file of what is decoded)"""
    coded, decoded = folder / "coded.drc", folder / "decoded.obj"
    for command in (
        ["draco_encoder", "-i", mesh_file, "-o", coded, "-cl", 10, "-qp", bits],
        ["draco_decoder", "-i", coded, "-o", decoded],
    ):
        ended = tools.run(command)
        if ended.code != 0:
            raise tools.Failure(f"{command[0]}: {tools.last_complaint(ended.output)}")
    return coded.stat().st_size, decoded


def decimations(model, targets, folder):
    """What decimation_run.py makes of a model."""
    source, result = folder / "in.npz", folder / "out.npz"
    points, _, indices = model.triangles
    np.savez(source, points=points, faces=indices.reshape(-1, 3), bits=BITS)
    ended = tools.run([venv_python(), tools.HERE / "decimation_run.py", source, result, *targets])
    if ended.code != 0:
        raise tools.Failure(tools.last_complaint(ended.output))
    return np.load(result)


def others(native, model):
    """{codec: [(bytes, distance)]} of decimations of a model, by Draco and by meshoptimizer with zstd. Both round positions in the same way, so that the
    distances are those of what Draco decodes."""
    most = len(model.triangles[2]) // 3
    targets = [round(LEAST_TRIANGLES * RUNG**i) for i in range(40) if LEAST_TRIANGLES * RUNG**i < min(most, 30000)]
    points = {"draco": [], "meshoptimizer": []}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = decimations(model, targets, folder)
        for target in targets:
            faces = made[f"faces {target}"]
            native.write_mesh(folder / "mesh.obj", made[f"points {target}"], np.arange(0, faces.size + 1, 3), faces.ravel())
            for bits in BITS:
                size, decoded = draco(folder / "mesh.obj", bits, folder)
                try:
                    found = distance(native, model.mesh, native.read_mesh(decoded))
                except native.Error:  # nothing is left of it
                    continue
                points["draco"].append((size, found))
                points["meshoptimizer"].append((int(made[f"meshoptimizer {target} {bits}"]), found))
    return points


def pareto_front(points):
    """Of (bytes, distance): those that no other one beats in both, by bytes. It is not made convex: what is between two of them is not to be had by mixing."""
    best = []
    for size, found in sorted(points):
        if not best or found < best[-1][1]:
            best.append((size, found))
    return np.array(best)


def bytes_at(points, error):
    """Bytes at a distance on the Pareto front, straight in logarithms between two of its points; None beyond it."""
    best = pareto_front(points)
    if not best[-1, 1] <= error <= best[0, 1]:
        return None
    return float(np.exp(np.interp(-np.log(error), -np.log(best[:, 1]), np.log(best[:, 0]))))
