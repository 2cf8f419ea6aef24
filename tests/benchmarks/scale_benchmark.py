# SPDX-License-Identifier: GPL-3.0-or-later
"""How time and memory grow with the size of the input: a model is cut finer again and again, each triangle in four, and each size is remeshed. Where
time grows as n log n, with n the vertices of the input, the column of seconds by n log n stays the same. The rows are also written as
build/bench/scale.csv."""

import argparse
import math
import sys
from pathlib import Path

import bench
import numpy as np
import tools
from bench import native
from finer_meshes import finer

# heading, key, format
FIGURES = [
    ("vertices", "vertices", "{:d}"),
    ("made", "made", "{:d}"),
    ("s", "seconds", "{:.2f}"),
    ("CPU s", "cpu_seconds", "{:.2f}"),
    ("MiB", "memory_mib", "{:.0f}"),
    ("L2", "l2", "{:.2e}"),
    ("us/(n log n)", "microseconds_by_n_log_n", "{:.4f}"),
    ("CPU us/(n log n)", "cpu_microseconds_by_n_log_n", "{:.4f}"),
]


def default_model():
    models = tools.ROOT.parent / "shared/models/buddha.ply"
    return models if models.is_file() else tools.ROOT / "blend_samples/bunny.ply"


def remesh(points, triangles, options):
    return bench.apart("timed_remesh.py", (points, np.arange(0, triangles.size + 1, 3), triangles.ravel().astype(np.int32)), *options)


def row_of(points, measured):
    n = len(points)
    by_n_log_n = 1e6 / (n * math.log(n))
    return {
        "vertices": n,
        "made": measured["vertices"],
        "seconds": measured["seconds"],
        "cpu_seconds": measured["cpu_seconds"],
        "memory_mib": measured["peak_memory_bytes"] / 2**20,
        "l2": measured["l2"],
        "microseconds_by_n_log_n": by_n_log_n * measured["seconds"],
        "cpu_microseconds_by_n_log_n": by_n_log_n * measured["cpu_seconds"],
        **{f"cpu_seconds.{stage}": seconds for stage, seconds in measured["cpu_seconds_by_stage"].items()},
    }


def line_of(cells):
    return "".join(cell.rjust(max(10, len(heading) + 2)) for cell, (heading, _, _) in zip(cells, FIGURES))


def text_of(row):
    stages = ", ".join(f"{key.split('.', 1)[1]} {seconds:.2f}" for key, seconds in row.items() if key.startswith("cpu_seconds."))
    return f"{line_of([pattern.format(row[key]) for _, key, pattern in FIGURES])}  {stages}"


def parse(argv):
    made = argparse.ArgumentParser(prog="bench scale", usage="%(prog)s [MODEL] [OPTIONS] [-- REMESH OPTIONS]", description=__doc__)
    made.add_argument("model", nargs="?", type=Path, default=default_model(), help="a .ply, .obj, .off or .stl file (default: %(default)s)")
    made.add_argument("--vertices", type=int, default=20000, help="of the remesh (default %(default)s); 0: as many as the input")
    made.add_argument("--sizes", type=int, default=3, metavar="N", help="the model as it is and N - 1 finer ones (default %(default)s)")
    made.add_argument("--output", type=Path, default=tools.ROOT / "build/bench/scale.csv", help="the rows as CSV")
    end = argv.index("--") if "--" in argv else len(argv)
    arguments, options = made.parse_args(argv[:end]), argv[end + 1 :]
    if not arguments.model.is_file():
        made.error(f"there is no {arguments.model}")
    if arguments.sizes < 1 or arguments.vertices < 0:
        made.error("there must be a size at least, and no negative number of vertices")
    return arguments, [*(["--vertices", str(arguments.vertices)] if arguments.vertices else []), *options]


def main(argv):
    arguments, options = parse(argv)
    points, _, indices = native.repair(*native.read_mesh(arguments.model))[:3]
    points, triangles = np.asarray(points), np.asarray(indices).reshape(-1, 3)
    print(f"{arguments.model.name}, remeshed with {' '.join(options) or 'no options'}")
    print(f"{line_of([heading for heading, _, _ in FIGURES])}  CPU seconds by stage", flush=True)
    records = []
    for size in range(arguments.sizes):
        if size > 0:
            points, triangles = finer(points, triangles, seed=size)
        measured, failure = bench.attempt(remesh, points, triangles, options)
        if failure:
            print(f"{len(points)} vertices: {failure}")
            return 1
        records.append(row_of(points, measured))
        print(text_of(records[-1]), flush=True)
        bench.write_csv(records, arguments.output)
    print(f"rows in {arguments.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
