# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes every model of a folder that has handles, boundaries or several components twice from a minimal base: with its topology opening late, and with
all of it in the base. A row has the distance and the CPU seconds of both, the number of base quads, and for each level on which something opened how many
quads it was and the 5th percentile of their scaled Jacobians there. A level that is no manifold, or has less topology than the one before, is named below the table. The rows are also written as build/bench/openings.csv."""

import sys

import bench

# heading, key, format
FIGURES = [
    ("L2 late", "l2", "{:.2e}"),
    ("base", "base.l2", "{:.2e}"),
    ("ratio", "l2_ratio", "{:.2f}"),
    ("CPU late", "cpu_seconds", "{:.1f}"),
    ("base", "base.cpu_seconds", "{:.1f}"),
    ("ratio", "cpu_ratio", "{:.2f}"),
    ("N0", "n0_quads", "{:d}"),
    ("verdict", "verdict", "{}"),
]


def has_topology(model):
    return model.euler != 2 or model.boundary_loops > 0


def defects(levels):
    """What is wrong with the topology of a late mesh's levels, a line each."""
    for number, level in enumerate(levels):
        if level["nonmanifold_edges"] or level["nonmanifold_vertices"]:
            yield f"N{number} is no 2-manifold"
        if number and (level["genus"] < levels[number - 1]["genus"] or level["components"] < levels[number - 1]["components"]):
            yield f"N{number} has less topology than N{number - 1}"


def row_of(model, vertices, options):
    asked = ["--vertices", str(vertices), "--base-quads", "min", *options]
    late = bench.apart("timed_remesh.py", model.triangles, *asked, "--topology", "late")
    base = bench.apart("timed_remesh.py", model.triangles, *asked, "--topology", "base")
    row = {"model": model.name, "verdict": late["verdict"]["result"], "n0_quads": late["levels"][0]["faces"]}
    for key in ("vertices", "l2", "seconds", "cpu_seconds", "peak_memory_bytes"):
        row.update({key: late[key], f"base.{key}": base[key]})
    row.update(l2_ratio=late["l2"] / base["l2"], cpu_ratio=late["cpu_seconds"] / base["cpu_seconds"])
    row.update({f"cpu_seconds.{stage}": seconds for stage, seconds in late["cpu_seconds_by_stage"].items()})
    for number, level in enumerate(late["levels"]):
        if level["opened_quads"]:
            row.update({f"N{number}.quads": level["opened_quads"], f"N{number}.p05": level["opened_p05"]})
    row["topology"] = " ".join("{genus}/{components}/{boundary_loops}".format(**level) for level in late["levels"])
    row["defects"] = "; ".join(defects(late["levels"]))
    return row


def text_of(row):
    cells = [pattern.format(row[key]).rjust(max(9, len(heading) + 2)) for heading, key, pattern in FIGURES]
    opened = [f"{key[:-4]} {row[key]:.2f} of {row[key[:-3] + 'quads']}" for key in row if key.endswith(".p05")]
    return row["model"].ljust(18) + "".join(cells) + "  " + ", ".join(opened)


def main(argv):
    made = bench.parser("bench openings", __doc__, "openings.csv")
    arguments, options = bench.parse(made, argv)
    records, failures = [], []
    print("model".ljust(18) + "".join(heading.rjust(max(9, len(heading) + 2)) for heading, _, _ in FIGURES) + "  scaled Jacobian p05 where it opens", flush=True)
    for path in arguments.paths:
        model = bench.load_model(path)
        if not has_topology(model):
            continue
        row, failure = bench.attempt(row_of, model, arguments.vertices, options)
        if failure:
            failures.append(f"{model.name}: {failure}")
            continue
        print(text_of(row), flush=True)
        if row["defects"]:
            failures.append(f"{model.name}: {row['defects']}")
        records.append(row)
        bench.write_csv(records, arguments.output)
    for line in failures:
        print(line)
    print(f"rows in {arguments.output}")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
