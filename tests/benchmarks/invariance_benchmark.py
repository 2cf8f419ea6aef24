# SPDX-License-Identifier: GPL-3.0-or-later
"""How much the result changes where it should not: the L2 distance over several seeds, and that of the same surface moved, turned and scaled,
as a change from the first seed's. The rows are also written as build/bench/invariance.csv."""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import bench
import numpy as np
import tools
from bench import native


def rotation():
    """Not aligned with anything."""
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14)
    k = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + np.sin(1.0) * k + (1 - np.cos(1.0)) * k @ k


# name: points and diagonal to points
TRANSFORMS = {
    "moved": lambda points, diagonal: points + 1000 * diagonal * np.array([1.0, -1.0, 1.0]) / np.sqrt(3),
    "turned": lambda points, diagonal: points @ rotation().T,
    "x 0.001": lambda points, diagonal: points * 1e-3,
    "x 1000": lambda points, diagonal: points * 1e3,
}


def l2_of(model, arguments, options):
    """Of a remesh, or a Failure; the remesh must have the topology of what was read."""
    outcome = tools.hybrid_mesh(native, model, arguments.vertices, options)
    ours, theirs = native.topology(*outcome.mesh), native.topology(*model.triangles)
    for name in ("genus", "components", "boundary_loops", "nonmanifold_edges", "nonmanifold_vertices", "misoriented_edges"):
        if ours[name] != theirs[name]:
            raise tools.Failure(f"{name} is {ours[name]}, not {theirs[name]}")
    return native.compare(*model.mesh, *outcome.mesh)["l2"]


def diagonal_of_unit_area(model):
    """Distances are relative to the bounding box, which a rotation changes: this makes them relative to the square root of the area."""
    points, _, indices = model.triangles
    a, b, c = (np.asarray(points)[np.asarray(indices).reshape(-1, 3)[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    return np.linalg.norm(np.ptp(np.asarray(points), axis=0)) / np.sqrt(area)


def l2_of_transformed(model, name, arguments, options):
    with tempfile.TemporaryDirectory() as folder:
        other = transformed(model, name, folder)
        return l2_of(other, arguments, options) * diagonal_of_unit_area(other) / diagonal_of_unit_area(model)


def transformed(model, name, folder):
    points, offsets, indices = model.mesh
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    path = Path(folder) / f"{model.name}.ply"
    native.write_mesh(path, TRANSFORMS[name](points, diagonal), offsets, indices)
    return replace(bench.load_model(path), name=model.name)


def run_model(model, arguments, options):
    """The row of one model, and failures."""
    record, failures = {"model": model.name}, []
    for seed in range(1, arguments.seeds + 1):
        record[f"seed {seed}"], failure = bench.attempt(l2_of, model, arguments, [*options, "--seed", str(seed)])
        failures += [f"seed {seed}: {failure}"] if failure else []
    for name in TRANSFORMS:
        record[name], failure = bench.attempt(l2_of_transformed, model, name, arguments, [*options, "--seed", "1"])
        failures += [f"{name}: {failure}"] if failure else []
    return record, failures


def line_of(record, seeds):
    values = [record[f"seed {seed}"] for seed in range(1, seeds + 1)]
    first = values[0]
    known = [value for value in values if value is not None]
    cells = [record["model"].ljust(22), "-".rjust(10) if first is None else f"{first:10.2e}"]
    cells.append(f"{100 * (max(known) - min(known)) / min(known):10.1f}" if known else "-".rjust(10))
    for name in TRANSFORMS:
        cells.append("-".rjust(10) if first is None or record[name] is None else f"{100 * (record[name] / first - 1):+10.1f}")
    return "".join(cells)


def main(argv):
    made = bench.parser("bench invariance", __doc__, "invariance.csv")
    made.add_argument("--seeds", type=int, default=5)
    arguments, options = bench.parse(made, argv)
    print("model".ljust(22) + "".join(name.rjust(10) for name in ["L2", "seeds %", *[f"{name} %" for name in TRANSFORMS]]), flush=True)
    records, failures = [], []
    for path in arguments.paths:
        record, failed = run_model(bench.load_model(path), arguments, options)
        print(line_of(record, arguments.seeds), flush=True)
        records.append(record)
        failures += [f"{path.stem}: {line}" for line in failed]
        bench.write_csv(records, arguments.output)
    print("\n".join([*failures, f"rows in {arguments.output}"]))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
