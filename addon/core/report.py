# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports: the JSON beside every remesh, the summary of a batch, and the figures that a panel shows."""

import copy
import csv
import hashlib
import io
import json
import sys

SUMMARY_COLUMNS = (
    "name", "input", "status", "error", "input_vertices", "input_faces", "base_quads", "levels", "vertices", "quads", "l2", "hausdorff",
    "boundary_hausdorff", "irregular_vertices", "regular_fraction", "scaled_jacobian_min", "scaled_jacobian_p05", "scaled_jacobian_p50",
    "inverted", "self_intersections", "seconds", "peak_memory_bytes", "verdict", "reasons", "warnings",
)  # fmt: skip


def to_json(report):
    """Deterministic, readable JSON text that ends with a line break."""
    return json.dumps(report, indent=1, ensure_ascii=False) + "\n"


def resume_hash(chunks, settings, version):
    """What tells a finished input from one to be done again: its bytes, the settings and the version.

    chunks: bytes-like pieces of the input in order; settings: RemeshSettings.reported().
    """
    digest = hashlib.sha256()
    digest.update(json.dumps([version, settings], sort_keys=True).encode())
    for chunk in chunks:
        digest.update(chunk)
    return digest.hexdigest()


def file_chunks(path, size=1 << 20):
    with open(path, "rb") as file:
        while chunk := file.read(size):
            yield chunk


def irregular_count(final):
    """Irregular vertices of a final mesh, whatever made them."""
    counts = final.get("irregular_vertices", 0)
    return sum(counts.values()) if isinstance(counts, dict) else counts


def verdict(report):
    """"good" or "poor"; empty where there is no verdict: the mesh has changed since it was measured, or there is none."""
    return (report.get("verdict") or {}).get("result", "")


def reasons(report):
    """What makes the result of a report poor: [{what, text, perhaps where}]."""
    return (report.get("verdict") or {}).get("reasons", [])


def reason_line(reason):
    """A reason in one line, with its place."""
    where = f" (at {', '.join(f'{value:.6g}' for value in reason['where'])})" if "where" in reason else ""
    return reason["text"] + where


def quality(report):
    """The figures that people judge a remesh by, from a report; missing ones are None."""
    final = report.get("final", {})
    jacobian = final.get("scaled_jacobian") or {}
    return {
        "vertices": final.get("vertices"),
        "quads": final.get("quads"),
        "triangles": final.get("triangles"),
        "l2": final.get("l2"),
        "hausdorff": final.get("hausdorff"),
        "boundary_hausdorff": final.get("boundary_hausdorff"),
        "irregular_vertices": irregular_count(final),
        "regular_fraction": final.get("regular_fraction"),
        "scaled_jacobian_min": jacobian.get("min"),
        "scaled_jacobian_p05": jacobian.get("p05"),
        "scaled_jacobian_p50": jacobian.get("p50"),
        "inverted": jacobian.get("inverted"),
        "self_intersections": final.get("self_intersections"),
    }


def repatched(report, operation, outcome, most_vertices=0):
    """The report of a hierarchy after one more operation, of which only that part was measured.

    operation: {kind, level, quads, new_quads}; outcome: of the native repatch(); most_vertices: the bound that the remesh was given.
    Distances, shapes and verdict of what has changed are None: they were not measured again.
    """
    made = copy.deepcopy(report)
    first = operation["level"]
    for level in made.get("levels", []):
        number = level.get("level", -1)
        if number < first:
            continue
        level.update(outcome["levels"].get(number, {}))
        level.update(l2=None, hausdorff=None, closed_surface=None, scaled_jacobian=None, stretch=None, irregular_vertices=None)
        if number == first:
            level.setdefault("irregular_ops", []).append(
                {"kind": operation["kind"], "removed_quads": len(operation["quads"]), "new_quads": len(operation["new_quads"])}
            )
    final = made.get("final", {})
    measured = (
        "l2", "hausdorff", "boundary_hausdorff", "regular_fraction", "irregular_vertices", "scaled_jacobian", "self_intersections",
        "self_intersections_of_input",
    )  # fmt: skip
    final.update(dict.fromkeys(measured))
    finest = outcome["levels"][max(outcome["levels"])]
    final.update(finest)
    made.update(verdict=None, warnings=[])
    if made.get("density"):
        made["density"]["met"] = None
        made["warnings"].append(f"the density {made['density']['name']!r} does not apply to the new quads, which are even; a remesh with the plan makes them follow it")
    if made.pop("symmetry", None):
        made["warnings"].append("the mesh is no longer symmetric: only one side of it was laid out anew")
    before, after = outcome["energy_before"], outcome["energy_after"]
    if not after < before:
        made["warnings"].append(f"the new quads are no better than those that they replace: their distortion, with the rings around, was {before:.3g} and is {after:.3g}")
    if most_vertices and finest["vertices"] > most_vertices:
        made["warnings"].append(f"there are {finest['vertices']:,} vertices now, more than the bound of {most_vertices:,}")
    return made


def summary_row(name, source, status, report=None, error=""):
    """One line of summary.csv as a dictionary; status is done, skipped or failed."""
    row = dict.fromkeys(SUMMARY_COLUMNS, "")
    row.update(name=name, input=source, status=status, error=error)
    if report and "final" in report:
        row.update({key: value for key, value in quality(report).items() if key in row and value is not None})
        row["input_vertices"] = report.get("input", {}).get("vertices", "")
        row["input_faces"] = report.get("input", {}).get("faces", "")
        row["base_quads"] = report.get("base", {}).get("quads", "")
        row["levels"] = len(report.get("levels", []))
        row["seconds"] = report.get("seconds", {}).get("total", "")
        row["peak_memory_bytes"] = report.get("peak_memory_bytes", "")
        row["verdict"] = verdict(report)
        row["reasons"] = "; ".join(reason_line(reason) for reason in reasons(report))
        row["warnings"] = "; ".join(report.get("warnings", []))
    return row


def summary_csv(rows):
    text = io.StringIO()
    writer = csv.DictWriter(text, SUMMARY_COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def level_table(report):
    """Lines of a table of the levels, for people."""
    lines = [f"{'level':<8}{'vertices':>10}{'quads':>10}{'irregular':>11}{'L2':>12}{'Hausdorff':>12}"]
    for level in report.get("levels", []):
        lines.append(
            f"{_level_name(level):<8}{level.get('vertices', 0):>10,}{level.get('quads', 0):>10,}"
            f"{_whole(irregular_count(level)):>11}{_scientific(level.get('l2')):>12}{_scientific(level.get('hausdorff')):>12}"
        )
    return lines


def peak_memory_bytes():
    """The largest resident size of this process so far, or None where the system does not say."""
    try:
        # Not ru_maxrss: Linux carries the parent's value over into the process it starts.
        with open("/proc/self/status", encoding="ascii", errors="replace") as status:
            for line in status:
                if line.startswith("VmHWM:"):
                    return int(line.split()[1]) * 1024
    except OSError:
        pass
    try:
        import resource
    except ImportError:
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024


def _level_name(level):
    name = level.get("level", "")
    return name if isinstance(name, str) else f"N{name}"


def _whole(value):
    return "" if value is None else f"{value:,}"


def _scientific(value):
    return "" if value is None else f"{value:.2e}"
