# SPDX-License-Identifier: GPL-3.0-or-later
"""What a child process does: one job, one answer. A job is a dictionary with a `kind`, the name of the function that does it."""

import json
import os
import sys
import threading
import time

from . import report as reports
from . import settings as settings_module
from .native import explain, native
from .process import PROGRESS_MARK, RESULT_MARK
from .version import VERSION

PROGRESS_SECONDS = 0.5  # between two words on how far a job is


def main(jobs):
    """Reads a job from stdin, does it, writes the answer; returns the exit code.

    jobs: {kind: function that takes a job and returns its answer}, JOBS and perhaps others.
    """
    job = json.loads(_first_line())
    threading.Thread(target=_end_with_parent, daemon=True).start()
    try:
        answer = jobs[job["kind"]](job)
    except Exception as error:  # Everything becomes one line: the parent has nothing else to show.
        cause = explain(error, job.get("path"))
        # Nobody knows the folder that outputs wait in until they are complete.
        answer = {"error": cause.replace(job["folder"] + os.sep, "") if "folder" in job else cause}
    sys.stdout.flush()
    # Straight to the descriptor: where Python's stdout is block-buffered or replaced the answer must not be lost.
    os.write(1, ("\n" + RESULT_MARK + json.dumps(answer) + "\n").encode())
    return 0


def remesh(job):
    """Remeshes one input into the staging folder: every output complete, or an error."""
    began = time.monotonic()
    module = native()
    settings = settings_module.from_mapping(job["settings"])
    density = None
    if job.get("arrays"):
        *mesh, density = _load_arrays(job["arrays"])
    else:
        refuse_unreadable(job["path"])
        if settings.density:
            *mesh, density = module.read_mesh(job["path"], settings.density)
        else:
            mesh = module.read_mesh(job["path"])
    read = time.monotonic()
    result = _watched(module.start_remesh(*mesh, settings.native(), density))
    worked = time.monotonic()

    stem = os.path.join(job["folder"], job["name"])
    report = finished_report(result.report, job, settings)
    kept = {"name": job["name"], "settings": settings.reported(), "version": VERSION, "verdict": report.get("verdict")}
    result.hierarchy.save(stem + ".hmesh", json.dumps(kept))
    write_text(stem + ".plan.json", result.plan)
    z_up = bool(job.get("arrays"))  # Blender's; what a file's axes mean nobody knows
    if job["exports"]:
        final = result.final_mesh()
        for form in job["exports"]:
            _write_mesh(f"{stem}.{form}", job["name"], final, z_up)
    if job["levels"]:
        levels = [(f"N{number}", result.hierarchy.level(f"N{number}")) for number in range(len(report.get("levels", [])))]
        for form in job["levels"]:
            if form == "glb":
                _write_glb(f"{stem}.levels.glb", levels, z_up)
            else:
                for name, level in levels:
                    _write_mesh(f"{stem}.{name}.{form}", name, level, z_up)
    if job["repaired"]:
        repaired = dict(zip(("points", "offsets", "indices"), result.repaired()))
        for form in job["exports"] or ["ply"]:
            _write_mesh(f"{stem}.repaired.{form}", job["name"], repaired, z_up)
    seconds = {"read": round(read - began, 4), **report.get("seconds", {})}
    seconds["write"] = round(time.monotonic() - worked, 4)
    seconds.pop("total", None)  # the native part's; here is the whole, and it stands last
    seconds["total"] = round(time.monotonic() - began, 4)
    report["seconds"] = seconds
    report["peak_memory_bytes"] = reports.peak_memory_bytes()
    write_text(stem + ".report.json", reports.to_json(report))
    return {"report": report}


def _write_mesh(path, name, mesh, z_up):
    if path.endswith(".glb"):
        _write_glb(path, [(name, mesh)], z_up)
    else:
        native().write_mesh(path, mesh["points"], mesh["offsets"], mesh["indices"])


def _write_glb(path, meshes, z_up):
    from . import gltf  # which needs NumPy; where there is none, this module still loads to say so

    gltf.write(path, meshes, z_up)


def _watched(running):
    """The result of a native job; the parent reads meanwhile how far it is."""
    told = None
    while not running.wait(PROGRESS_SECONDS):
        now = (round(running.progress, 3), running.stage)
        if now != told:
            os.write(1, ("\n" + PROGRESS_MARK + json.dumps(now) + "\n").encode())
            told = now
    return running.result()


def finished_report(text, job, settings):
    """The native report with what only the command line knows, in the order that people read it in."""
    made = json.loads(text)
    source = {"file": os.path.basename(job["path"])}
    if job.get("object"):
        source["object"] = job["object"]
    report = {"input": {**source, **made.pop("input", {})}}
    report.update(made)
    report["version"] = VERSION
    report["settings"] = settings.reported()
    report["hash"] = job["hash"]
    return report


def compare(job):
    module = native()
    meshes = []
    for path in job["paths"]:
        job["path"] = path
        try:
            refuse_unreadable(path)
            meshes.append(module.read_mesh(path))
        except Exception as error:
            return {"error": f"{path}: {explain(error, path)}"}
    return {"distance": module.compare(*meshes[0][:3], *meshes[1][:3], job["samples"])}


def info(job):
    module = native()
    refuse_unreadable(job["path"])
    hierarchy = module.load_hierarchy(job["path"])
    answer = {"info": {**json.loads(hierarchy.info()), "verdict": _kept_verdict(hierarchy.metadata)}}
    if job["check"]:
        answer["problems"] = list(hierarchy.check())
    return answer


def encode(job):
    """Writes a hierarchy as a stream."""
    module = native()
    refuse_unreadable(job["path"])
    hierarchy = module.load_hierarchy(job["path"])
    surface = None
    if job["source"]:
        refuse_unreadable(job["source"])
        surface = module.read_mesh(job["source"])
    written = hierarchy.save_stream(job["output"], most_bytes=job["bytes"], error=job["error"], exact=job["exact"], surface=surface)
    return {"bytes": written}


def decode(job):
    """Writes the final mesh or a level of a hierarchy, of a stream as far as it is to be read."""
    module = native()
    refuse_unreadable(job["path"])
    hierarchy = module.load_hierarchy(job["path"], most_bytes=job["bytes"])
    mesh = hierarchy.final_mesh() if job["level"] is None else hierarchy.level(f"N{job['level']}")
    module.write_mesh(job["output"], mesh["points"], mesh["offsets"], mesh["indices"])
    return {"vertices": len(mesh["points"]), "faces": len(mesh["offsets"]) - 1}


def _kept_verdict(metadata):
    """The verdict on the remesh that a hierarchy was saved by; None where it was made in another way."""
    try:
        kept = json.loads(metadata)
    except ValueError:
        return None
    return kept.get("verdict") if isinstance(kept, dict) else None


def write_text(path, text):
    with open(path, "w", encoding="utf-8", errors="surrogateescape", newline="\n") as file:
        file.write(text)


JOBS = {"remesh": remesh, "compare": compare, "info": info, "encode": encode, "decode": decode}


def refuse_unreadable(path):
    """Raises the operating system's own words, before a reader finds some of its own."""
    with open(path, "rb") as file:
        if not file.read(1):
            raise ValueError("the file is empty")


def _load_arrays(path):
    import numpy

    with numpy.load(path) as arrays:
        return arrays["points"], arrays["offsets"], arrays["indices"], arrays["density"] if "density" in arrays else None


def _first_line():
    """What the parent writes: one line, and nothing after it. A plan in it may be long."""
    pieces = []
    while not pieces or not pieces[-1].endswith(b"\n"):
        piece = os.read(0, 1 << 16)
        if not piece:
            break
        pieces.append(piece)
    return b"".join(pieces)


def _end_with_parent():
    while os.read(0, 4096):
        pass
    os._exit(1)
