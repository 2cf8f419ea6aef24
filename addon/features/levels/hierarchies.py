# SPDX-License-Identifier: GPL-3.0-or-later
"""A native hierarchy as a collection of objects that knows what it is."""

import bpy

from ...bridge import levels
from . import kept, properties


def build(context, name, at_hand, report, plan="", place=None, source=None, carry=None):
    """The objects of a kept.Kept, with what was measured and decided; returns levels.Built. On an error nothing is left behind.

    place, source, carry: as levels.build() has them; None where the hierarchy was made of no object.
    """
    hierarchy = at_hand.hierarchy
    parts = [(level, hierarchy.level(level)) for level in hierarchy.level_names]
    built = levels.build(name, parts, at_hand.matrix, context.scene, place, source, carry)
    try:
        properties.describe(built, source, report, plan, map(hierarchy.operation, range(hierarchy.operation_count)))
        levels.show_preview_only(built)
        kept.keep(built.collection, at_hand)
    except BaseException:
        remove(built)
        raise
    return built


def remove(built):
    """Takes back what build() has made."""
    plan = built.collection.hybrid_mesh.plan
    kept.drop(built.collection)
    levels.remove(built)
    if plan is not None:
        bpy.data.texts.remove(plan)
