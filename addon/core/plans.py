# SPDX-License-Identifier: GPL-3.0-or-later
"""Plans: what was decided in a remesh, as JSON that a remesh can be given again. A quad's address is its root quad and the child taken at each level."""

import json
import math
import re

from .limits import limits

FORMAT = "hybrid-mesh plan"
VERSION = 1
FITS = ("tight", "drawn")


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


def repatch_operation(level, addresses, layout, buffer_rings):
    """The operation that lays out the quads at `addresses` anew.

    layout: of drawn_layout(), automatic_layout(), cubes_layout(), rows_layout(), even_layout() or template_layout(); buffer_rings: how many rings of quads around them are smoothed.
    """
    quads = [str(one) for one in addresses]
    if not quads:
        raise PlanError("no quads are given")
    _whole("level", level, 1, limits().most_levels)
    _whole("buffer rings", buffer_rings, 0, limits().most_buffer_rings)
    return {"level": level, "quads": quads, **layout, "buffer_rings": buffer_rings}


def drawn_layout(strokes):
    """New quads whose sides are drawn. strokes: (points, fit) with (n, 3) points in world space and fit 'tight' or 'drawn'."""
    curves = []
    for number, (points, fit) in enumerate(strokes):
        if fit not in FITS:
            raise PlanError(f"the fit of stroke {number} must be one of {', '.join(FITS)}, not {fit!r}")
        curves.append({"points": _points(points, f"stroke {number} has points"), "fit": fit})
    if not curves:
        raise PlanError("no curves are given")
    return {"curves": curves}


def automatic_layout():
    """New quads that fill the region so that its corners become regular."""
    return {"layout": "automatic"}


def cubes_layout(height=0):
    """A tower of so many cubes on the region; 0: as many as make its sides square."""
    _whole("height", height, 0, limits().most_cubes)
    return {"layout": "cubes", "height": height}


def rows_layout(height=0):
    """So many rows of quads on a region that is a ring: from one of its rims to the other, or to the surface's boundary; 0: as many as make them square."""
    _whole("rows", height, 0, limits().most_cubes)
    return {"layout": "rows", "height": height}


def even_layout(quads=0):
    """Quads of even size for a region of any topology, about so many; 0: as many as it has."""
    _whole("even quads", quads, 0, limits().most_even_quads)
    return {"layout": "even", "even_quads": quads}


def template_layout(address, side, new_quads):
    """Quads as another region got them. `side` of the quad at `address` is where the region's corner 0 begins.

    new_quads: rows of four nodes, 0, 1, ... the corners of the region's boundary, counter-clockwise, then the new ones.
    """
    _whole("start's side", side, 0, 3)
    quads = [[int(node) for node in quad] for quad in new_quads]
    if not quads or any(len(quad) != 4 or min(quad) < 0 for quad in quads):
        raise PlanError("a template's new quads must be rows of four nodes")
    return {"layout": "template", "start": [str(address), side], "new_quads": quads}


def boundary_plan(nodes=None, cubes=0):
    """A plan's text whose base is a chain of cubes on four points of a disk's boundary.

    nodes: four points in world space, in any order; None: they are found. cubes: 0 for as many as make their sides square.
    """
    _whole("cubes", cubes, 0, limits().most_cubes)
    points = "automatic" if nodes is None else _points(nodes, "the boundary has nodes")
    if nodes is not None and len(points) != 4:
        raise PlanError(f"a base on a boundary has four nodes there, not {len(points)}")
    return to_text({"format": FORMAT, "version": VERSION, "base": {"boundary_nodes": points, "cubes": cubes}})


def topology_plan(cuts):
    """A plan's text that says nothing but which handles and tunnels are closed on the base: the rest of the topology is in the base, all else is searched for.

    cuts: (points, level) of loops, (n, 3) points in world space; level: the first one that may have it open, -1 for the first one with room for it.
    """
    events = []
    for number, (points, level) in enumerate(cuts):
        event = {"kind": "cut", "loops": [_points(points, f"loop {number} has points")]}
        if level != -1:
            _whole("loop's level", level, 1, limits().most_levels)
            event["level"] = level
        events.append(event)
    return to_text({"format": FORMAT, "version": VERSION, "topology": events})


def line_key(points):
    """Stands for a loop's points, in whatever order they are."""
    return frozenset(tuple(float(value) for value in point) for point in points)


def opening_levels(text):
    """The level that each event of a remesh's plan opened on: {line_key() of its first loop: level}."""
    return {line_key(event["loops"][0]): event["level"] for event in parse(text).get("topology", ())}


def parse(text):
    """A plan's text as a dict; raises PlanError where it is no plan that this version can read."""
    try:
        plan = json.loads(text.removeprefix("\ufeff"), parse_constant=_refuse_constant)
    except RecursionError as error:
        raise PlanError("the plan is nested too deeply") from error
    except PlanError:
        raise
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


def in_lines(plan):
    """The text of a plan with a line for each point, quad and operation: one line of half a million characters takes Blender ten seconds to take in."""
    return re.sub(r"(?<=[\]}]),\s*(?=[\[{])", ",\n", plan)


def with_operation(plan_text, operation):
    """The plan with an operation after those that it has, as text."""
    plan = parse(plan_text)
    return to_text({**plan, "operations": [*plan.get("operations", []), operation]})


def _refuse_constant(word):
    # Python would read it, and nobody else what it then writes.
    raise PlanError(f"the plan has the number {word}, which JSON has not")


def _whole(name, value, least, most):
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise PlanError(f"the {name} must be a whole number from {least} to {most}, not {value!r}")


def _points(points, whose):
    rows = [[float(value) for value in point] for point in points]
    if any(len(row) != 3 or not all(map(math.isfinite, row)) for row in rows):
        raise PlanError(f"{whose} that are not three finite numbers")
    return rows
