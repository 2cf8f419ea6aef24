# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of quads: what their boundary is, and how the layout of one is put onto another. A quad is a row of four nodes, counter-clockwise; its side k goes
from its corner k to the next."""

from .plans import PlanError


def boundary(quads):
    """The sides (quad, side) around a region, counter-clockwise; raises PlanError where it is no disk whose boundary does not touch itself."""
    sides = {}
    for number, quad in enumerate(quads):
        for side in range(4):
            ends = quad[side], quad[(side + 1) % 4]
            if ends in sides:
                raise PlanError("the region's quads do not lie side by side")
            sides[ends] = number, side
    outer = [(start, end) for start, end in sides if (end, start) not in sides]
    following = dict(outer)
    if not outer or len(following) < len(outer):
        raise PlanError("the region's boundary touches itself" if outer else "the region has no boundary")
    found, node = [], outer[0][0]
    for _ in outer:
        found.append(sides[node, following[node]])
        node = following[node]
        if node == outer[0][0]:
            break
    if len(found) < len(outer):
        raise PlanError("the region is in several parts, or has a hole")
    return found


def corner_counts(quads, sides):
    """How many quads of the region meet where each side of its boundary begins: 1 at a corner that juts out, 2 where it runs on, more at one that recedes."""
    found = dict.fromkeys((node for quad in quads for node in quad), 0)
    for quad in quads:
        for node in quad:
            found[node] += 1
    return [found[quads[quad][side]] for quad, side in sides]


def copy_start(quads, counts, turn=0):
    """The side (quad, side) of a region at which a copied layout begins: so that corners come to corners, and then `turn` sides on.

    counts: corner_counts() of the region that it is copied from, from the layout's corner 0 on; all 0 where they are not known.
    """
    sides = boundary(quads)
    if len(sides) != len(counts):
        raise PlanError(f"the region has {len(sides)} sides, and the one whose layout is to be copied {len(counts)}")
    own = corner_counts(quads, sides)
    count = len(sides)
    shift = min(range(count), key=lambda first: sum(own[(first + k) % count] != counts[k] for k in range(count)))
    return sides[(shift + turn) % count]
