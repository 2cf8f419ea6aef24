# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the loops along which every model of a folder is cut to genus 0 and prints a row each: how long they are together, by the diagonal of the
bounding box, and what that took. Then buddha, if it is there, cut finer twice, and a ball with a thousand tiny handles, which are closed. Beside
them the basis loops of MeshLib (two for each handle) if Python can import it. The rows are also written as build/bench/topology.csv."""

import importlib.util
import sys

import bench
import numpy as np
from bench import native
from finer_meshes import finer

# heading, key, format
FIGURES = [
    ("points", "points", "{:d}"),
    ("genus", "genus", "{:.0f}"),
    ("loops", "loops", "{:d}"),
    ("handles", "handles", "{:d}"),
    ("length", "length", "{:.4f}"),
    ("longest", "longest", "{:.4f}"),
    ("s", "seconds", "{:.3f}"),
    ("CPU s", "cpu_seconds", "{:.3f}"),
    ("MiB", "memory_mib", "{:.0f}"),
]
VERSUS = [("ML loops", "meshlib.loops", "{:d}"), ("ML length", "meshlib.length", "{:.4f}"), ("ML s", "meshlib.seconds", "{:.3f}")]


def row_of(name, mesh, *what):
    points = np.asarray(mesh[0])
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    row = bench.apart("timed_loops.py", mesh, *what)
    row.update(model=name, points=len(points), genus=native.topology(*mesh)["genus"], memory_mib=row.pop("peak_memory_bytes") / 2**20)
    row.update({key: row[key] / diagonal for key in ("length", "longest") if key in row})
    if importlib.util.find_spec("meshlib") and not what and row["genus"] > 0:
        other = bench.apart("timed_loops.py", mesh, "meshlib")
        row.update({"meshlib.loops": other["loops"], "meshlib.length": other["length"] / diagonal, "meshlib.seconds": other["seconds"]})
    return row


def subdivided(model, times):
    points, triangles = np.asarray(model.triangles[0]), np.asarray(model.triangles[2]).reshape(-1, 3)
    for seed in range(1, times + 1):
        points, triangles = finer(points, triangles, seed)
    return points, np.arange(0, triangles.size + 1, 3), triangles.ravel().astype(np.int32)


def noisy_ball(rows, handles):
    """A ball of a grid of quads, with tubes of three sides between triangles that are a quad apart."""
    columns = 2 * rows
    v, u = np.mgrid[1:rows, 0:columns]
    polar, around = np.pi * v / rows, 2 * np.pi * u / columns
    points = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1).reshape(-1, 3)
    points = [*points, np.array([0, 0, 1.0]), np.array([0, 0, -1.0])]
    at = lambda i, j: (i % (rows - 1)) * columns + j % columns  # noqa: E731
    top, bottom = len(points) - 2, len(points) - 1
    faces = [(top, at(0, j), at(0, j + 1)) for j in range(columns)] + [(bottom, at(rows - 2, j + 1), at(rows - 2, j)) for j in range(columns)]
    spots = [(i, j) for i in range(rows // 5, 4 * rows // 5, 3) for j in range(0, columns - 4, 4)]
    spots = set(spots[:: max(1, len(spots) // handles)][:handles])
    if len(spots) < handles:
        raise ValueError("the ball is too small for so many handles")
    lift = 1.0 + 2.0 / rows
    for i in range(rows - 2):
        for j in range(columns):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            near, far = (i, j) in spots, (i, j - 2) in spots
            if not near:
                faces.append((a, b, c))
            if not far:
                faces.append((a, c, d))
            if near:  # from this quad's first triangle to the second one of the next but one
                start, end = (a, b, c), (at(i, j + 2), at(i + 1, j + 3), at(i, j + 3))
                end = (end[0], end[2], end[1])  # the hole's other way round
                middle = [len(points) + k for k in range(3)]
                points += [lift * (points[p] + points[q]) / 2 for p, q in zip(start, end)]
                for one, two in ((start, middle), (middle, end)):
                    for k in range(3):
                        n = (k + 1) % 3
                        faces += [(one[k], one[n], two[n]), (one[k], two[n], two[k])]
    faces = np.array(faces, np.int32)
    return native.repair(np.array(points), np.arange(0, faces.size + 1, 3), faces.ravel())[:3]


def parse(argv):
    made = bench.parser("bench topology", __doc__, "topology.csv")
    made.add_argument("--no-large", action="store_true", help="without buddha cut finer and the ball with noise")
    return bench.parse(made, argv)[0]


class Table:
    def __init__(self, output):
        self.columns = FIGURES + (VERSUS if importlib.util.find_spec("meshlib") else [])
        self.output, self.records, self.failures = output, [], []
        print("model".ljust(24) + "".join(heading.rjust(max(9, len(heading) + 2)) for heading, _, _ in self.columns), flush=True)

    def add(self, name, make, *what):
        row, failure = bench.attempt(lambda: row_of(name, make(), *what))
        if failure:
            self.failures.append(f"{name}: {failure}")
            return
        cells = [pattern.format(row[key]) if key in row else "-" for _, key, pattern in self.columns]
        print(name.ljust(24) + "".join(cell.rjust(max(9, len(heading) + 2)) for cell, (heading, _, _) in zip(cells, self.columns)), flush=True)
        self.records.append(row)
        bench.write_csv(self.records, self.output)


def main(argv):
    arguments = parse(argv)
    table = Table(arguments.output)
    buddha = None
    for path in arguments.paths:
        model = bench.load_model(path)
        buddha = model if model.name == "buddha" else buddha
        table.add(model.name, lambda model=model: model.triangles)
    if not arguments.no_large:
        if buddha:
            table.add("buddha, finer twice", lambda: subdivided(buddha, 2))
        table.add("1,000 handles, closed", lambda: noisy_ball(160, 1000), "noise", 1.0)
    for line in table.failures:
        print(line)
    print(f"rows in {arguments.output}")
    return 1 if table.failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
