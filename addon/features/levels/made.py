# SPDX-License-Identifier: GPL-3.0-or-later
"""Ordinary objects made of a hierarchy: beside it and no part of it, but they know what they come of."""

import bpy

from ...bridge import levels, objects, placement
from ...bridge.names import with_suffix
from .properties import hierarchy_of, is_level, level_number, name_of, origin_of


def make_object(context, collection, mesh, suffix, level):
    """An object of a mesh that was made of a level, where the hierarchy stands."""
    mesh.name = with_suffix(name_of(collection), suffix)
    obj = bpy.data.objects.new(mesh.name, mesh)
    around, scene = _collection_around(context, collection), context.scene.collection
    around.objects.link(obj)
    context.view_layer.update()
    if around != scene and not (objects.in_view_layer(obj, context.view_layer) and obj.visible_get()):
        scene.objects.link(obj)  # That collection is hidden or left out of the view layer.
    # The preview is what is seen of a hierarchy, and may have been moved by itself.
    stands = collection.hybrid_mesh.preview or level_object(collection, level)
    if stands is not None:
        placement.same_place(stands)(obj)
    obj.hybrid_mesh.made_of = collection
    obj.hybrid_mesh.made_level = level
    return obj


def remove(obj):
    """Takes back an object that make_object() has made, and its mesh."""
    mesh = obj.data
    bpy.data.objects.remove(obj)
    if mesh.users == 0:
        bpy.data.meshes.remove(mesh)


def level_object(collection, name):
    """The object of the level of that name, or None where it is gone."""
    found = (obj for obj in collection.objects if is_level(obj) and obj.hybrid_mesh.hierarchy == collection and obj.type == "MESH")
    return next((obj for obj in found if obj.hybrid_mesh.level == name), None)


def shown_level(collection):
    """The object of the level that the preview shows, or None where it is gone."""
    preview = collection.hybrid_mesh.preview
    shown = levels.shown_object(preview) if preview is not None else None
    return shown if is_level(shown) else None


def finest_level(collection):
    """The object of the finest level there is, or None."""
    found = (obj for obj in collection.objects if is_level(obj))
    return max(found, key=lambda obj: level_number(obj.hybrid_mesh.level), default=None)


def chosen_hierarchies(context):
    """The hierarchies that the selected objects belong to, were made of, or were the sources of, each once, by name; without any, the active object's."""
    found = {hierarchy_of(obj) or origin_of(obj) for obj in context.view_layer.objects.selected} - {None}
    active = objects.active(context)
    if not found and active is not None:
        found = {hierarchy_of(active) or origin_of(active)} - {None}
    return sorted(found, key=lambda collection: collection.name)


def _collection_around(context, collection):
    """The collection that a hierarchy is in."""
    scene = context.scene.collection
    return next((one for one in (scene, *scene.children_recursive) if collection in one.children.values()), scene)
