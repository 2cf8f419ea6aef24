# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes models, encodes them as streams, and prints the bytes at which a stream's prefix comes as near to the scan as each of five L2 distances (the
larger direction, a fraction of the scan's diagonal), beside those that decimated meshes take in Draco and in meshoptimizer with zstd: the Pareto
front over numbers of triangles and bits of positions. The rows are also written as build/bench/codec.csv, the curves as codec.png beside it."""

import sys
import tempfile
import time
from pathlib import Path

import bench
import numpy as np
import rate_distortion
import tools
from bench import native

ERRORS = [20e-4, 10e-4, 5e-4, 2e-4, 1e-4]
MODELS = ["feline", "bunny", "horse", "armadillo", "max_planck", "camel", "mannequin"]  # where no folder is given
# What gives good streams unless options are given: see docs/reference/command_line.md.
VERTICES = 20000
OTHERS = ["draco", "meshoptimizer"]


def models_of(folder):
    paths = bench.models_of(folder)
    return paths if folder else [path for name in MODELS for path in paths if path.stem == name]


def command_line(*words):
    """Seconds of a command that must succeed."""
    start = time.perf_counter()
    ended = tools.run(["/usr/bin/python3", "-m", "hybrid_mesh", *words], {"PYTHONPATH": str(tools.STAGE)})
    if ended.code != 0:
        raise tools.Failure(tools.last_complaint(ended.output))
    return time.perf_counter() - start


def ours(model, arguments, options):
    """(row, [(bytes, distance)])"""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        kept = arguments.hierarchies / f"{model.name}.hmesh" if arguments.hierarchies else None
        row = {}
        if kept is None or not kept.exists():
            row["remesh_seconds"] = command_line("remesh", model.path, "--output", folder, "--vertices", arguments.vertices, *options)
            made = folder / f"{model.name}.hmesh"
            if kept:
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_bytes(made.read_bytes())
        else:
            made = kept
        stream = folder / "stream.hmesh"
        row["base_quads"] = base_quads(made)
        row["encode_seconds"] = command_line("encode", made, stream, *arguments.encode)
        row["decode_seconds"] = command_line("decode", stream, "--output", folder / "decoded.ply")
        prefixes = rate_distortion.Prefixes(native, stream, model.mesh)
        row["floor"] = prefixes.distance(prefixes.whole)
        for error in ERRORS:
            row[column("ours", error)] = prefixes.shortest(error)
        return row, sorted((size, found) for size, found in prefixes.known.items() if np.isfinite(found))


def base_quads(hierarchy):
    mesh = native.load_hierarchy(hierarchy).level("N0")
    return len(mesh["offsets"]) - 1


def column(codec, error):
    return f"{codec} {error * 1e4:g}e-4"


def run_model(path, arguments, options):
    """(row, {codec: [(bytes, distance)]}, why what is missing is missing)"""
    model = bench.load_model(path)
    row, curves, failures = {"model": model.name}, {}, []
    made, failure = bench.attempt(ours, model, arguments, options)
    if made:
        row.update(made[0])
        curves["ours"] = made[1]
    else:
        failures.append(f"{model.name}: {failure}")
    if arguments.versus:
        made, failure = bench.attempt(rate_distortion.others, native, model)
        for codec in arguments.versus if made else []:
            curves[codec] = made[codec]
            for error in ERRORS:
                size = rate_distortion.bytes_at(made[codec], error)
                row[column(codec, error)] = None if size is None else round(size)
        failures += [f"{model.name}: {failure}"] if failure else []
    return row, curves, failures


def ratios(rows, codec):
    """How many times the bytes of ours, by model and error; not where one of the two is missing."""
    found = []
    for row in rows:
        for error in ERRORS:
            mine, its = row.get(column("ours", error)), row.get(column(codec, error))
            if mine and its:
                found.append(its / mine)
    return found


def print_row(row, versus):
    cells = [row["model"].ljust(12)]
    for codec in ["ours", *versus]:
        sizes = [row.get(column(codec, error)) for error in ERRORS]
        cells.append(f"{codec} " + "/".join("-" if size is None else str(size) for size in sizes))
    for codec in versus:
        found = ratios([row], codec)
        if found:
            cells.append(f"{codec}/ours {geometric_mean(found):.2f} (least {min(found):.2f})")
    if "base_quads" in row:
        cells.append(f"base {row['base_quads']}, floor {row['floor'] * 1e4:.2f}e-4, encode {row['encode_seconds']:.1f} s, decode {row['decode_seconds']:.1f} s")
    print("  ".join(cells), flush=True)


def geometric_mean(values):
    return float(np.exp(np.mean(np.log(values))))


def draw(curves, path):
    """The curves of all models as a picture: {model: {codec: [(bytes, distance)]}}."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    columns = min(3, len(curves))
    figure, axes = pyplot.subplots(-(-len(curves) // columns), columns, figsize=(5 * columns, 4 * -(-len(curves) // columns)), squeeze=False)
    for axis in axes.flat[len(curves) :]:
        axis.axis("off")
    for axis, (name, of_model) in zip(axes.flat, curves.items()):
        for codec, points in of_model.items():
            line = np.array(points) if codec == "ours" else rate_distortion.pareto_front(points)
            axis.loglog(line[:, 0], line[:, 1], label=codec)
        axis.set(title=name, xlabel="bytes", ylabel="L2 / diagonal", ylim=(5e-5, 5e-3))
        axis.grid(which="both", alpha=0.3)
        axis.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=100)


def parse(argv):
    parser = bench.parser("bench codec", __doc__, "codec.csv")
    parser.set_defaults(vertices=VERTICES)
    parser.add_argument("--versus", metavar="CODEC,CODEC", default=",".join(OTHERS), help="draco, meshoptimizer; '' for neither, which is quick")
    parser.add_argument("--encode", metavar="OPTIONS", default="", help="of our encoder")
    parser.add_argument("--hierarchies", type=Path, metavar="FOLDER", help="takes remeshes from there, and keeps there what it makes")
    arguments, options = bench.parse(parser, argv, models_of)
    arguments.versus = [codec for codec in arguments.versus.split(",") if codec]
    arguments.encode = arguments.encode.split()
    if not set(arguments.versus) <= set(OTHERS):
        parser.error(f"--versus knows {' and '.join(OTHERS)}")
    return arguments, options


def main(argv):
    arguments, options = parse(argv)
    rows, curves, failures = [], {}, []
    for path in arguments.paths:
        row, of_model, failed = run_model(path, arguments, options)
        print_row(row, arguments.versus)
        rows.append(row)
        curves[row["model"]] = of_model
        failures += failed
        bench.write_csv(rows, arguments.output)
    for codec in arguments.versus:
        found = ratios(rows, codec)
        if found:
            print(f"{codec} takes {geometric_mean(found):.2f} times our bytes in the geometric mean, {min(found):.2f} at least")
    picture = arguments.output.with_suffix(".png")
    draw(curves, picture)
    for line in failures:
        print(line)
    print(f"rows in {arguments.output}, curves in {picture}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
