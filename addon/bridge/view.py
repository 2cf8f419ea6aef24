# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the user is and looks: mode, selection, 3D views."""

import contextlib

import bpy
import mathutils

from . import objects


def to_object_mode(context):
    if objects.active(context) is not None and context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")


def select_only(context, *chosen):
    """Selects these objects and nothing else; the last one is active."""
    for other in list(context.view_layer.objects.selected):
        other.select_set(False)
    for obj in chosen:
        obj.select_set(True)
    context.view_layer.objects.active = chosen[-1]


def views(context):
    """The areas of the window that are 3D views."""
    return [area for area in context.window.screen.areas if area.type == "VIEW_3D"] if context.window is not None else []


def redraw(context):
    for area in views(context):
        area.tag_redraw()


def shade(context, colors):
    """Has the 3D views of the window show surfaces in colours (of solid shading: MATERIAL, VERTEX, ...); rendered views stay as they are where these are the material's."""
    for area in views(context):
        shading = area.spaces.active.shading
        if colors != "MATERIAL":
            shading.type = "SOLID"
        if shading.type == "SOLID" and (colors != "MATERIAL" or shading.color_type == "VERTEX"):
            shading.color_type = colors
        area.tag_redraw()


def look_at(context, surface, place, size):
    """Turns the 3D views of the window to a place, from outside the surface; returns how many there are."""
    areas = views(context)
    inverse = surface.matrix_world.inverted_safe()
    try:
        found, _, normal, _ = surface.evaluated_get(context.evaluated_depsgraph_get()).closest_point_on_mesh(inverse @ place)
    except RuntimeError:  # It has no faces any more.
        found = False
    outward = (inverse.to_3x3().transposed() @ normal).normalized() if found else None
    for area in areas:
        view = area.spaces.active.region_3d
        if view.view_perspective == "CAMERA":
            view.view_perspective = "PERSP"
        toward = view.view_rotation @ mathutils.Vector((0, 0, 1))
        if outward is not None and toward.dot(outward) < 0.5:
            view.view_rotation = outward.to_track_quat("Z", "Y")
        view.view_location = place
        view.view_distance = 10 * size
    return len(areas)


@contextlib.contextmanager
def waiting(context):
    """Has the pointer say that something takes a while."""
    window = None if bpy.app.background else context.window
    if window is not None:
        window.cursor_set("WAIT")
    try:
        yield
    finally:
        if window is not None:
            window.cursor_set("DEFAULT")
