# SPDX-License-Identifier: GPL-3.0-or-later
"""What the benchmarks share: the models, the command line, the rows."""

import argparse
import csv
import json
import os
import sys
import tempfile
from pathlib import Path

import numpy as np
import tools

sys.path.insert(0, str(tools.STAGE))
from hybrid_mesh import _native as native  # noqa: E402

SUFFIXES = {".ply", ".obj", ".off", ".stl"}


def default_folder():
    candidates = [os.environ.get("HYBRID_MESH_MODELS"), tools.ROOT.parent / "shared/models", tools.ROOT / "blend_samples"]
    return next(Path(folder) for folder in candidates if folder and Path(folder).is_dir())


def load_model(path):
    mesh = native.read_mesh(path)
    triangles = native.repair(*mesh)[:3]
    topology = native.topology(*triangles)
    return tools.Model(path.stem, path, mesh, triangles, topology["euler"], topology["boundary_loops"])


def attempt(function, *arguments):
    """(outcome, None) or (None, why not)."""
    try:
        return function(*arguments), None
    except tools.Failure as failure:
        return None, str(failure)


def apart(script, mesh, *arguments):
    """What a script of this folder, timed_remesh.py or timed_loops.py, measures of a mesh in a process of its own, or a Failure."""
    with tempfile.TemporaryDirectory() as folder:
        source, result = Path(folder) / "in.npz", Path(folder) / "out.json"
        np.savez(source, points=mesh[0], offsets=mesh[1], indices=mesh[2])
        code, output, *_ = tools.run(["/usr/bin/python3", tools.HERE / script, source, result, *arguments], {"PYTHONPATH": str(tools.STAGE)})
        if code != 0:
            raise tools.Failure(f"exit code {code}: {tools.last_complaint(output)}")
        return json.loads(result.read_text())


def write_csv(records, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    keys = list(dict.fromkeys(key for record in records for key in record))
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, keys)
        writer.writeheader()
        writer.writerows(records)


def parser(name, description, rows):
    made = argparse.ArgumentParser(prog=name, usage="%(prog)s [FOLDER] [OPTIONS] [-- REMESH OPTIONS]", description=description)
    made.add_argument("folder", nargs="?", type=Path, help="of .ply, .obj, .off, .stl files")
    made.add_argument("--models", metavar="A,B", help="only these, by name")
    made.add_argument("--vertices", type=int, default=20000)
    made.add_argument("--adaptive", action="store_true")
    made.add_argument("--output", type=Path, default=tools.ROOT / "build/bench" / rows, help="the rows as CSV")
    return made


def meshes_in(folder):
    return sorted(path.resolve() for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)


def models_of(folder):
    """What is measured: all meshes of a folder, or of the default one."""
    return meshes_in(folder or default_folder())


def parse(made, argv, models_of=models_of):
    """(arguments with the models' `paths`, options for our own command line). models_of: the paths for a folder, or for None where none is given."""
    end = argv.index("--") if "--" in argv else len(argv)
    arguments, options = made.parse_args(argv[:end]), argv[end + 1 :]
    if arguments.folder and not arguments.folder.is_dir():
        made.error(f"there is no folder {arguments.folder}")
    arguments.paths = models_of(arguments.folder)
    where = arguments.folder or default_folder()
    if arguments.models:
        names = arguments.models.split(",")
        missing = set(names) - {path.stem for path in arguments.paths}
        if missing:
            made.error(f"{where} has no {', '.join(sorted(missing))}")
        arguments.paths = [path for path in arguments.paths if path.stem in names]
    if not arguments.paths:
        made.error(f"no meshes in {where}")
    return arguments, options + (["--adaptive"] if arguments.adaptive else [])
