# SPDX-License-Identifier: GPL-3.0-or-later
"""The legend in the 3D view: which level is shown, and what its colours mean."""

import blf
import bpy
from gpu_extras.batch import batch_for_shader

from ... import compat
from ...bridge import levels, units
from ...core import legend
from ..levels import made
from . import coloring, properties

_TITLES = {"PATCHES": "Patches: a colour a quad of the base", "STRETCH": "Stretch", "ERROR": "Distance to the source"}
_SIZE, _LINE, _LEFT, _BOTTOM = 12, 18, 60, 60  # pixels at a scale of 1; below is the panel of the last operation
_handle = None


def register():
    global _handle
    if not bpy.app.background:
        _handle = bpy.types.SpaceView3D.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")


def unregister():
    global _handle
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
        _handle = None


def lines(context):
    """(colour or None, text) from the top line down; none where there is nothing to say."""
    collection, mode = properties.shown_hierarchy(context), context.scene.hybrid_mesh_display.mode
    preview = collection.hybrid_mesh.preview if collection is not None else None
    shown = levels.shown_object(preview) if preview is not None else None
    if shown is None or not (preview.visible_get() or shown.visible_get()):
        return []
    faces = len(shown.data.polygons)
    made_lines = [(None, f"{made.name_of(collection)}  {shown.hybrid_mesh.level}  {faces:,} faces")]
    if mode in _TITLES:
        made_lines.append((None, _TITLES[mode]))
    if mode == "STRETCH":
        made_lines += legend.stretch_entries()
    elif mode == "ERROR":
        made_lines += legend.error_entries(coloring.diagonal_of(collection), lambda length: units.length_text(context.scene, length))
    return made_lines


def _draw():
    context = bpy.context
    if not context.scene.hybrid_mesh_display.legend or not context.space_data.overlay.show_overlays:
        return
    found = lines(context)
    if not found:
        return
    scale = context.preferences.system.ui_scale
    left, line, box = _LEFT * scale, _LINE * scale, _SIZE * scale
    blf.enable(0, blf.SHADOW)
    compat.font_size(0, _SIZE * scale)
    blf.color(0, 1, 1, 1, 1)
    blf.shadow(0, 5, 0, 0, 0, 0.9)
    for number, (color, text) in enumerate(reversed(found)):
        y = _BOTTOM * scale + number * line
        if color is not None:
            _rectangle(left, y - 0.1 * box, box, (*(value ** (1 / 2.2) for value in color), 1))
        blf.position(0, left + (1.6 * box if color is not None else 0), y, 0)
        blf.draw(0, text)
    blf.disable(0, blf.SHADOW)


def _rectangle(x, y, size, color):
    shader = compat.flat_shader()
    corners = [(x, y), (x + size, y), (x + size, y + size), (x, y + size)]
    batch = batch_for_shader(shader, "TRIS", {"pos": corners}, indices=[(0, 1, 2), (0, 2, 3)])
    shader.bind()
    shader.uniform_float("color", color)
    batch.draw(shader)

