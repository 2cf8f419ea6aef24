# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a level to people who make things of it; the full figures are a table of their own."""

from . import report as reports
from .legend import percent

# Of the scaled Jacobian, 1 for a square: what the worst twentieth of the quads has at least.
_GOOD, _FAIR = 0.6, 0.35


def figures_of(report, level, finest):
    """What was measured of a level, by its name (M2, N2); finest: whether it is the last one. Empty where it was not measured."""
    if finest:
        return report.get("final") or {}
    found = (one for one in report.get("levels", []) if one.get("level") == level or f"N{one.get('level')}" == level)
    return next(found, {})


def lines(figures, diagonal, length_text):
    """Lines of a read-out, without what was not measured. length_text(length): a length in the scene's units."""
    said = []
    if figures.get("hausdorff") is not None:
        said.append(f"Largest deviation {length_text(figures['hausdorff'] * diagonal)} ({percent(figures['hausdorff'])})")
    poles = reports.irregular_count(figures) if figures.get("irregular_vertices") is not None else None
    if poles is not None:
        said.append("No poles" if not poles else f"{poles:,} pole{'' if poles == 1 else 's'}")
    shape = quad_shape(figures.get("scaled_jacobian") or {}, figures.get("quads") or 0)
    if shape:
        said.append(f"Quad shape: {shape}")
    return said


def quad_shape(jacobian, quads):
    """In a word, and how many quads are folded; empty where it was not measured."""
    worst = jacobian.get("p05")
    if worst is None:
        return ""
    folded = round((jacobian.get("inverted") or 0) * quads)
    return ("good" if worst >= _GOOD else "fair" if worst >= _FAIR else "poor") + (f", {folded:,} folded" if folded else "")


def time_left(progress, seconds):
    """About how long work goes on that has come so far, in words; empty while that is a guess."""
    if not 0.05 <= progress < 1 or seconds < 2:
        return ""
    left = seconds * (1 - progress) / progress
    if left < 60:
        return f"{max(5, 5 * round(left / 5))} s left"
    return f"{round(left / 60)} min left" if left < 5400 else f"{left / 3600:.1f} h left"
