# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes every model of a folder and prints a row each, beside other tools' if asked. All are measured in the same way, against the file as it
was read. The rows are also written as build/bench/remesh.csv."""

import sys

import bench
import tools
from bench import native
from quality import measure

# heading, key, format
FIGURES = [
    ("vertices", "vertices", "{:d}"),
    ("L2", "l2", "{:.2e}"),
    ("Hausdorff", "hausdorff", "{:.2e}"),
    ("boundary", "boundary_hausdorff", "{:.2e}"),
    ("Q", "q", "{:.2f}"),
    ("irreg.", "irregular", "{:d}"),
    ("SJ p05", "sj_p05", "{:.3f}"),
    ("SJ med.", "sj_median", "{:.3f}"),
    ("inv. %", "inverted_percent", "{:.3f}"),
    ("s", "seconds", "{:.1f}"),
    ("MiB", "memory_mib", "{:.0f}"),
]
SHORT = {"quadriflow": "QF", "instant-meshes": "IM"}
# What is put beside ours of another tool.
VERSUS_KEYS = ["vertices", "l2", "q", "irregular", "sj_p05", "sj_median", "inverted_percent", "seconds"]


def figures_of(model, outcome):
    row = measure(native, model.mesh, outcome.mesh)
    row.update(seconds=outcome.seconds, memory_mib=outcome.peak_memory_bytes / 2**20)
    return row


def text_of(key, pattern, row):
    value = row.get(key)
    return "-" if value is None or (key == "boundary_hausdorff" and value < 0) else pattern.format(value)


class Table:
    """Prints rows as they come, in columns wide enough for what is expected of them."""

    def __init__(self, versus):
        self.columns = [("model", 20)] + [(heading, max(9, len(heading) + 1)) for heading, _, _ in FIGURES]
        for tool in versus:
            self.columns += [(f"{SHORT[tool]} {heading}", 12) for heading, key, _ in FIGURES if key in VERSUS_KEYS]
            self.columns += [(f"{SHORT[tool]} L2/ours", 12)]
        self.print([heading for heading, _ in self.columns] + ["  seconds by stage"])

    def print(self, cells):
        widths = [width for _, width in self.columns] + [0]
        line = "".join(cell.ljust(width) if i == 0 else cell.rjust(width) for i, (cell, width) in enumerate(zip(cells, widths)))
        print(line, flush=True)


def run_model(path, arguments, options):
    """The row of one model: cells to print, and everything for the file."""
    model = bench.load_model(path)
    record = {"model": model.name}
    cells = [model.name]
    outcome, failure = bench.attempt(tools.hybrid_mesh, native, model, arguments.vertices, options)
    ours = figures_of(model, outcome) if outcome else {"failure": failure}
    record.update(ours)
    cells += [text_of(key, pattern, ours) for _, key, pattern in FIGURES]
    failures = [f"hybrid_mesh: {failure}"] if failure else []
    for tool in arguments.versus:
        other, failure = bench.attempt(tools.VERSUS[tool], model, arguments.vertices)
        row = figures_of(model, other) if other else {"failure": failure}
        row["l2_over_ours"] = row["l2"] / ours["l2"] if other and outcome else None
        record.update({f"{tool}.{key}": value for key, value in row.items()})
        cells += [text_of(key, pattern, row) for _, key, pattern in FIGURES if key in VERSUS_KEYS]
        cells.append(text_of("l2_over_ours", "{:.2f}", row))
        failures += [f"{tool}: {failure}"] if failure else []
    stages = outcome.stages if outcome else {}
    record.update({f"seconds.{stage}": seconds for stage, seconds in stages.items()})
    cells.append("  " + ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in stages.items()))
    return cells, record, failures, outcome is not None


def parse(argv):
    parser = bench.parser("bench remesh", __doc__, "remesh.csv")
    parser.add_argument("--versus", metavar="TOOL,TOOL", default="", help="quadriflow, instant-meshes")
    arguments, options = bench.parse(parser, argv)
    arguments.versus = [tool for tool in arguments.versus.split(",") if tool]
    unknown = set(arguments.versus) - set(tools.VERSUS)
    if unknown:
        parser.error(f"--versus knows quadriflow and instant-meshes, not {', '.join(sorted(unknown))}")
    return arguments, options


def main(argv):
    arguments, options = parse(argv)
    table = Table(arguments.versus)
    records, failures, all_done = [], [], True
    for path in arguments.paths:
        cells, record, failed, done = run_model(path, arguments, options)
        table.print(cells)
        records.append(record)
        failures += [f"{path.stem}: {line}" for line in failed]
        all_done = all_done and done
        bench.write_csv(records, arguments.output)
    for line in failures:
        print(line)
    print(f"rows in {arguments.output}")
    return 0 if all_done else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
