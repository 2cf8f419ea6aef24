# SPDX-License-Identifier: GPL-3.0-or-later
"""Plans: what was decided in a remesh, as JSON that a remesh can be given again. A quad's address is its root quad and the child taken at each level."""

import json
import math

FORMAT = "hybrid-mesh plan"
VERSION = 1
FITS = ("tight", "drawn")
MAXIMUM_BUFFER_RINGS = 8


class PlanError(ValueError):
    """A plan, or a part of one, that cannot be used; the message says why."""


def digits(path):
    """The children (0..3) that lead from a root quad to a quad. path: 1 followed by these digits in base 4; 1 is the root itself."""
    path = int(path)
    if path < 1 or path.bit_length() % 2 == 0:
        raise PlanError(f"{path} is no path from a root quad to a quad")
    found = []
    while path > 1:
        found.append(path & 3)
        path >>= 2
    return found[::-1]


def address(root, path):
    """The address of a quad as text: 12.0.3 is child 3 of child 0 of root quad 12."""
    if int(root) < 0:
        raise PlanError(f"{int(root)} is no number of a root quad")
    return ".".join(str(number) for number in (int(root), *digits(path)))


def root_levels(levels):
    """The level of each root quad: {root: level}, as the coarsest level that has it undivided tells.

    levels: (level, roots, paths) with a root and a path a face.
    """
    found = {}
    for level, roots, paths in levels:
        for root, path in zip(roots, paths, strict=True):
            if path == 1:
                found[int(root)] = min(level, found.get(int(root), level))
    return found


def quad_addresses(level, roots, paths, level_of_root):
    """Addresses, each once and in order, of quads that all are to be of `level`; raises PlanError where there are none or some are not.

    level_of_root: {root: level}; where it has nothing to say of a root, a quad is only refused if it is too deep.
    """
    if not len(roots):
        raise PlanError("no faces are selected")
    quads, other = set(), 0
    for root, path in zip(roots, paths, strict=True):
        root, children = int(root), digits(path)
        known = level_of_root.get(root)
        fits = len(children) <= level if known is None else known + len(children) == level
        other += not fits
        quads.add((root, *children))
    if other:
        raise PlanError(f"{other} of the {len(roots)} selected faces {'is' if other == 1 else 'are'} of another level than {level}, where quad sizes meet; deselect them")
    return [".".join(map(str, quad)) for quad in sorted(quads)]


def repatch_operation(level, addresses, strokes, buffer_rings):
    """The operation that lays out the quads at `addresses` anew along drawn curves.

    strokes: (points, fit) with (n, 3) points in world space and fit 'tight' or 'drawn'; buffer_rings: 0..8.
    """
    quads, curves = [str(one) for one in addresses], []
    if not quads:
        raise PlanError("no quads are given")
    if isinstance(level, bool) or not isinstance(level, int) or level < 0:
        raise PlanError(f"the level must be a whole number of at least 0, not {level!r}")
    if isinstance(buffer_rings, bool) or not isinstance(buffer_rings, int) or not 0 <= buffer_rings <= MAXIMUM_BUFFER_RINGS:
        raise PlanError(f"the buffer rings must be a whole number from 0 to {MAXIMUM_BUFFER_RINGS}, not {buffer_rings!r}")
    for number, (points, fit) in enumerate(strokes):
        rows = [[float(value) for value in point] for point in points]
        if any(len(row) != 3 or not all(map(math.isfinite, row)) for row in rows):
            raise PlanError(f"stroke {number} has points that are not three finite numbers")
        if fit not in FITS:
            raise PlanError(f"the fit of stroke {number} must be one of {', '.join(FITS)}, not {fit!r}")
        curves.append({"points": rows, "fit": fit})
    if not curves:
        raise PlanError("no curves are given")
    return {"level": level, "quads": quads, "curves": curves, "buffer_rings": buffer_rings}


def parse(text):
    """A plan's text as a dict; raises PlanError where it is no plan that this version can read."""
    try:
        plan = json.loads(text)
    except ValueError as error:
        raise PlanError(f"the plan is not JSON ({error})") from error
    if not isinstance(plan, dict) or plan.get("format") != FORMAT:
        raise PlanError(f"the text is no {FORMAT}")
    if plan.get("version") != VERSION:
        raise PlanError(f"the plan is of version {plan.get('version')!r}; this add-on reads version {VERSION}")
    if not isinstance(plan.get("operations", []), list):
        raise PlanError("the plan's operations are not a list")
    return plan


def to_text(plan):
    return json.dumps(plan, ensure_ascii=False, allow_nan=False)


def with_operation(plan_text, operation):
    """The plan with an operation after those that it has, as text."""
    plan = parse(plan_text)
    return to_text({**plan, "operations": [*plan.get("operations", []), operation]})
