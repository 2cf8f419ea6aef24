# SPDX-License-Identifier: GPL-3.0-or-later
"""The search for loops around handles and tunnels, beside loops that are there or drawn."""

import re
import sys
from dataclasses import dataclass
from typing import Any

from .loops import LoopError, is_cycle, numbers_at
from .native import native


def search(mesh, loops, strokes, complete):
    """Loops of a mesh: those that it had already and that can be kept, those that strokes are drawn for, and where they are to be complete those that
    are missing to make the genus.

    mesh: (points, offsets, indices); loops: [{points, drawn}], in the mesh's space as all points are; strokes: closed ones, (n, 3) points each. A drawn loop that
    cannot be kept is an error; others give way. Returns [{points, length, kind, drawn, source}]: `source` is the place in `loops`, or -1 for a new one.
    """
    module = native()
    mesh = module.repair(*mesh)[:3]
    own = [_Given(i, f"loop {i + 1}" if loop["drawn"] else "", _cycle(module, mesh, loop["points"])) for i, loop in enumerate(loops)]
    new = [_Given(-1, f"stroke {i + 1}", _snapped(module, mesh, stroke, f"stroke {i + 1}")) for i, stroke in enumerate(strokes)]
    for one in own:
        if one.name and one.cycle is None:
            raise LoopError(f"{one.name} is not on the surface any more")
    # What was drawn comes first: of two that are in each other's way the second one has to go.
    given = [*(one for one in own if one.name), *new, *(one for one in own if not one.name and one.cycle is not None)]
    found = _found(module, mesh, given, {} if complete else {"longest": sys.float_info.min})  # So short that there is none.
    sources = given + [_Given(-1, "", None)] * (len(found) - len(given))
    return [
        {"points": loop["positions"].tolist(), "length": loop["length"], "kind": loop["kind"], "drawn": bool(source.name), "source": source.place}
        for loop, source in zip(found, sources, strict=True)
    ]


@dataclass
class _Given:
    place: int  # in the loops that there were, or -1
    name: str  # of what is drawn
    cycle: Any  # numbers of the surface's points


def _found(module, mesh, given, options):
    """What the native search finds beside `given`, from which it removes what cannot be kept."""
    while True:
        try:
            return module.find_loops(*mesh, given=[one.cycle for one in given], **options)
        except module.InvalidInput as error:
            refused = re.match(r"loop (\d+) (.*)", str(error))
            if refused is None:
                raise
            one = given.pop(int(refused[1]))
            if one.name:
                raise LoopError(f"{one.name} {refused[2]}") from error


def _cycle(module, mesh, points):
    """Numbers of the surface's points that a loop goes through; None where it is not on the surface any more."""
    numbers = numbers_at(mesh[0], points)
    if is_cycle(numbers, mesh[2].reshape(-1, 3)):
        return numbers
    try:
        return module.snap_loop(*mesh, points, tighten=False)
    except module.Unsupported:
        return None


def _snapped(module, mesh, stroke, name):
    try:
        return module.snap_loop(*mesh, stroke)
    except module.Unsupported as error:
        raise LoopError(f"{name}: {error}") from error
