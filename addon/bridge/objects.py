# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects found again after a job, and evaluated where they are not seen."""

import contextlib

import bpy
import mathutils
import numpy


def active(context):
    """The active object, or None. Without a window the context has no member `object`."""
    return context.view_layer.objects.active


def key_of(block):
    """What finds a data-block again, whatever has become of it: a library may have one of the same name."""
    return block.name, block.library.filepath if block.library else None


def in_scene(obj, scene):
    return scene.objects.get(obj.name) == obj or any(one == obj for one in scene.objects)


def in_view_layer(obj, view_layer):
    return view_layer.objects.get(obj.name) == obj or any(one == obj for one in view_layer.objects)


def find(scene, key):
    """The object of the scene that has a key, or None."""
    obj = bpy.data.objects.get(key)
    return obj if obj is not None and in_scene(obj, scene) else None


def is_local(block):
    """Whether a data-block can be edited: it comes of no library, neither as a link nor as an override of one."""
    return block.library is None and block.override_library is None


def diagonal(obj):
    """The length of the diagonal of an object's bounding box in world space."""
    corners = numpy.array([obj.matrix_world @ mathutils.Vector(corner) for corner in obj.bound_box])
    return float(numpy.linalg.norm(numpy.ptp(corners, axis=0)))


def mirrored_axis(obj):
    """The axis ("x", "y" or "z") in which a Mirror modifier mirrors the object about its own origin; "" if none does, or they mirror in several ways."""
    mirrors = [modifier for modifier in obj.modifiers if modifier.type == "MIRROR" and modifier.show_viewport]
    if len(mirrors) != 1 or mirrors[0].mirror_object is not None or sum(mirrors[0].use_axis) != 1:
        return ""
    return "xyz"[list(mirrors[0].use_axis).index(True)]


@contextlib.contextmanager
def evaluated(context, obj):
    """Gives a dependency graph in which the object has its modifiers applied, also where it is switched off in the viewports or its collections are."""
    view_layer = context.view_layer
    if obj.visible_get() or (in_view_layer(obj, view_layer) and obj.hide_get() and not obj.hide_viewport):
        yield context.evaluated_depsgraph_get()
        return
    collection, hidden = context.scene.collection, obj.hide_viewport
    linked = obj not in collection.objects.values()
    try:
        if linked:
            collection.objects.link(obj)
        obj.hide_viewport = False
        obj.update_tag(refresh={"OBJECT", "DATA"})  # What was there for the sake of its children only has no modifiers applied.
        view_layer.update()
        yield context.evaluated_depsgraph_get()
    finally:
        obj.hide_viewport = hidden
        if linked:
            collection.objects.unlink(obj)
        view_layer.update()
