# SPDX-License-Identifier: GPL-3.0-or-later
"""Stands in for the compiled module where a test is about the Python around it.

Every surface becomes the box around it. What an input's file name says happens: crash, hang, refuse, poor. A box of more than 50 units is poor.
"""

import json
import os
import threading
import time

import numpy

__version__ = "0.1.0"


class Error(Exception):
    pass


class InvalidInput(Error):
    pass


class Unsupported(Error):
    pass


class Cancelled(Error):
    pass


class CorruptStream(Error):
    pass


class IoError(Error):
    pass


class InternalError(Error):
    pass


class LayoutError(InvalidInput):
    pass


def limits():
    """None is as in the library: a bound that the Python around it knows by itself shows."""
    return {
        "most_vertices": 1_000_003, "end_of_error": 0.75, "end_of_drop_components": 0.5, "end_of_remove_noise": 0.25, "most_levels": 9, "most_base_quads": 5003,
        "least_stretch_threshold": 1.5, "most_stretch_threshold": 2e3, "least_feature_angle": 7, "most_feature_angle": 160, "most_seed": 10_007, "most_threads": 67, "most_cubes": 31, "most_even_quads": 4099,
        "most_buffer_rings": 5, "most_snap": 0.3,
    }  # fmt: skip


SETTINGS = {
    "vertices", "error", "levels", "refinement", "faces", "base", "topology", "components", "remove_noise", "stretch_threshold", "semi_regular", "features",
    "symmetry", "symmetry_side", "effort",
    "drop_components", "strict", "seed", "threads", "plan", "density",
}  # fmt: skip


def read_mesh(path, density=""):
    name = os.path.basename(os.fsdecode(path))
    if "crash" in name:
        os.abort()
    if "hang" in name:
        time.sleep(600)
    if "refuse" in name:
        raise InvalidInput(f"{os.fsdecode(path)}: no faces")
    points, offsets, indices = [], [0], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                points.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                indices += [int(word) - 1 for word in words[1:]]
                offsets.append(len(indices))
    size = 100 if "poor" in name else 1
    mesh = size * numpy.array(points, dtype=float).reshape(-1, 3), numpy.array(offsets, dtype=numpy.int64), numpy.array(indices, dtype=numpy.int32)
    return (*mesh, numpy.full(len(points), 0.5)) if density else mesh


def write_mesh(path, points, offsets, indices):
    with open(path, "w", encoding="utf-8") as file:
        for point in points:
            file.write("v %r %r %r\n" % tuple(float(value) for value in point))
        for begin, end in zip(offsets[:-1], offsets[1:]):
            file.write("f " + " ".join(str(int(index) + 1) for index in indices[begin:end]) + "\n")


def topology(points, offsets, indices):
    return {"vertices": len(numpy.unique(indices)), "faces": len(offsets) - 1}


def compare(points_a, offsets_a, indices_a, points_b, offsets_b, indices_b, samples=200000):
    return {"l2": float(numpy.abs(points_a.mean(0) - points_b.mean(0)).max()), "hausdorff": 0.0}


CUBE = numpy.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float)
QUADS = numpy.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


def box(low, high, level):
    """A box of 6 * 4^level quads as a MeshDict."""
    points, quads, patch = CUBE, QUADS, numpy.arange(6)
    for _ in range(level):
        points, quads, patch = split(points, quads, patch)
    count = len(quads)
    return {
        "points": low + points * (high - low),
        "offsets": numpy.arange(0, 4 * count + 1, 4, dtype=numpy.int64),
        "indices": quads.ravel().astype(numpy.int32),
        "stretch": numpy.linspace(0.25, 4, count, dtype=numpy.float32),
        "anisotropy": numpy.ones(count, dtype=numpy.float32),
        "patch": patch.astype(numpy.int32),
        "irregular": patch == 0,
        "uv": numpy.tile(numpy.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=numpy.float32), (count, 1)),
        "source_face": numpy.zeros(len(points), dtype=numpy.int32),
        "source_weights": numpy.full((len(points), 3), 1 / 3, dtype=numpy.float32),
    }


def split(points, quads, patch):
    places = {}
    points = [tuple(point) for point in points]
    for number, point in enumerate(points):
        places[tuple(numpy.round(point, 9))] = number

    def at(corners):
        middle = numpy.mean([points[corner] for corner in corners], axis=0)
        key = tuple(numpy.round(middle, 9))
        if key not in places:
            places[key] = len(points)
            points.append(tuple(middle))
        return places[key]

    made = []
    for a, b, c, d in quads:
        ab, bc, cd, da, middle = at((a, b)), at((b, c)), at((c, d)), at((d, a)), at((a, b, c, d))
        made += [[a, ab, middle, da], [ab, b, bc, middle], [middle, bc, c, cd], [da, middle, cd, d]]
    return numpy.array(points), numpy.array(made), numpy.repeat(patch, 4)


class Hierarchy:
    def __init__(self, low, high, levels, metadata=""):
        self.low, self.high, self.count, self.metadata = numpy.asarray(low, float), numpy.asarray(high, float), levels, metadata

    @property
    def level_names(self):
        return [f"N{level}" for level in range(self.count)]

    def level(self, name):
        return box(self.low, self.high, int(name[1:]))

    def final_mesh(self):
        return box(self.low, self.high, self.count - 1)

    def save(self, path, metadata=""):
        with open(path, "w", encoding="utf-8") as file:
            json.dump([self.low.tolist(), self.high.tolist(), self.count, metadata], file)

    def save_stream(self, path, *, most_bytes=0, error=0.0, exact=False, surface=None):
        """As many bytes as there are levels to be had for."""
        if 0 < most_bytes < 10:
            raise InvalidInput("the base alone takes about 10 bytes")
        levels = self.count if not most_bytes else min(self.count, most_bytes // 10)
        levels = min(levels, 2) if error else levels
        text = "stream" + json.dumps([self.low.tolist(), self.high.tolist(), levels])
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return len(text)

    def check(self):
        return [] if (self.high > self.low).all() else ["the box is empty"]

    def info(self):
        return json.dumps({"levels": self.level_names, "metadata": self.metadata})


def load_hierarchy(path, *, most_bytes=0):
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if text.startswith("stream"):
            low, high, levels = json.loads(text[6:])
            return Hierarchy(low, high, min(levels, most_bytes // 10) if most_bytes else levels)
        if most_bytes:
            raise InvalidInput(f"{os.fsdecode(path)}: is no stream")
        return Hierarchy(*json.loads(text))
    except (ValueError, TypeError) as error:
        raise CorruptStream(f"{os.fsdecode(path)}: not a hierarchy") from error


class Result:
    def __init__(self, mesh, settings):
        points, offsets, indices = mesh
        levels = settings["levels"] + 1 if settings["levels"] >= 0 else 3
        self.hierarchy = Hierarchy(points.min(0), points.max(0), levels)
        self._mesh = mesh
        self.plan = settings.get("plan") or json.dumps({"format": "hybrid-mesh plan", "version": 1, "base": {}})
        final = self.final_mesh()
        count = len(final["offsets"]) - 1
        poor = numpy.ptp(points) > 50
        reasons = [{"what": "hausdorff", "text": "far off", "where": [1.0, 2.0, 0.1]}, {"what": "vertices", "text": "few, and fewer"}] if poor else []
        self.report = json.dumps({
            "input": {"vertices": len(points), "faces": len(offsets) - 1},
            "base": {"quads": 6, "vertices": 8},
            "levels": [
                {"level": level, "vertices": 6 * 4**level + 2, "quads": 6 * 4**level, "l2": 1e-3, "hausdorff": 1e-2, "irregular_vertices": 8}
                for level in range(levels)
            ],
            "final": {
                "vertices": len(final["points"]), "quads": count, "triangles": 0, "l2": 1e-3, "hausdorff": 1e-2,
                "irregular_vertices": {"base": 8, "operations": 0, "transitions": 0},
                "scaled_jacobian": {"min": 1, "p05": 1, "p50": 1, "inverted": 0}, "self_intersections": 0,
            },
            "verdict": {"result": "poor" if reasons else "good", "reasons": reasons},
            "seconds": {"base": 0.1, "total": 0.1},
        })  # fmt: skip

    def final_mesh(self):
        return self.hierarchy.final_mesh()

    def repaired(self):
        return self._mesh


def remesh(points, offsets, indices, settings, density=None):
    for name in settings:
        if name not in SETTINGS:
            raise InvalidInput(f"unknown setting {name}")
    if settings.get("density") and (density is None or len(density) != len(points)):
        raise InvalidInput(f"the density {settings['density']!r} has not one value a point")
    if settings["vertices"] and settings["vertices"] < 8:
        raise InvalidInput("the surface cannot be represented with fewer than 8 vertices")
    return Result((points, offsets, indices), settings)


class Job:
    """Takes HYBRID_MESH_FAKE_SECONDS, then has its result."""

    def __init__(self, mesh, settings, density=None):
        self._cancelled, self._settings, self._mesh, self._density = threading.Event(), settings, mesh, density
        self._began, self._seconds = time.monotonic(), float(os.environ.get("HYBRID_MESH_FAKE_SECONDS", "0.1"))
        self._thread = threading.Thread(target=self._cancelled.wait, args=(self._seconds,), daemon=True)
        self._thread.start()

    @property
    def progress(self):
        return min(1.0, (time.monotonic() - self._began) / max(self._seconds, 1e-9))

    @property
    def stage(self):
        return "waiting"

    @property
    def done(self):
        return not self._thread.is_alive()

    def cancel(self):
        self._cancelled.set()

    def wait(self, timeout_s=None):
        self._thread.join(timeout_s)
        return self.done

    def result(self):
        self.wait()
        if self._cancelled.is_set():
            raise Cancelled("cancelled")
        return remesh(*self._mesh, self._settings, self._density)


_jobs = []


def start_remesh(points, offsets, indices, settings, density=None):
    _jobs.append(Job((points, offsets, indices), settings, density))
    return _jobs[-1]


def shutdown_jobs():
    while _jobs:
        job = _jobs.pop()
        job.cancel()
        job.wait()
