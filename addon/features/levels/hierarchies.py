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


def take_over(built, collection):
    """Has a hierarchy's own collection and objects show what build() has made, in the place of what they show; returns levels.Built of these."""
    made, old = built.collection.hybrid_mesh, collection.hybrid_mesh
    old.report, old.operations, old.token = made.report, made.operations, made.token
    old.matrix = [value for column in made.matrix.transposed() for value in column]
    plan = made.plan
    if plan is not None and old.plan is not None:
        old.plan.from_string(plan.as_string())
    elif plan is not None:
        old.plan, plan = plan, None
    # What goes points at nothing that stays, and nothing at what goes.
    made.plan = made.preview = made.source = None
    for obj in (*built.levels, built.preview):
        obj.hybrid_mesh.hierarchy = collection
    before = {obj.hybrid_mesh.level: obj for obj in collection.objects if properties.is_level(obj) and obj.hybrid_mesh.hierarchy == collection}
    built = levels.take_over(built, collection, old.preview, before)
    if plan is not None:
        bpy.data.texts.remove(plan)
    old.preview = built.preview
    levels.show_preview_only(built)
    return built


def remove(built):
    """Takes back what build() has made."""
    plan = built.collection.hybrid_mesh.plan
    kept.drop(built.collection)
    levels.remove(built)
    if plan is not None:
        bpy.data.texts.remove(plan)
