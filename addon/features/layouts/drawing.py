# SPDX-License-Identifier: GPL-3.0-or-later
"""The Grease Pencil objects of layouts: the one that is drawn in, and those that show what became of it."""

from dataclasses import dataclass, replace

import bpy
import numpy

from ... import compat
from ...bridge import arrays, objects, placement, strokes
from ...bridge.names import with_suffix
from . import properties

FIT = "hybrid_mesh_fit"  # on a material: how strokes drawn in it become curves
_INK = "hybrid_mesh_ink"
# Linear RGBA.
_INKS = {
    "tight": ("Layout Tight", (0.01, 0.08, 0.60, 1)),
    "drawn": ("Layout As Drawn", (0.55, 0.16, 0.01, 1)),
    "curve": ("Layout Curves", (0.01, 0.35, 0.08, 1)),
    "node": ("Layout Nodes", (0.02, 0.02, 0.02, 1)),
    "problem": ("Layout Problems", (0.85, 0.01, 0.01, 1)),
}
_DRAWING_INKS = ("tight", "drawn")
_LAYER = "Layout"
_THINNER = -12  # pixels: brushes are made for drawings, and half of a wide stroke sinks into the surface
# Fractions of the surface's bounding-box diagonal.
_LINE_RADIUS, _MARK_RADIUS = 0.001, 0.0025
_NODE_SIZE, _MARK_SIZE = 0.006, 0.02


class LayoutInputError(ValueError):
    """There is nothing to make a layout of, or to draw one in; the message says what is missing."""


@dataclass
class Drawn:
    """What is drawn on a mesh object, without bpy data: those may go while a job works on it."""

    layout: tuple  # objects.key_of() the layout
    strokes: list  # of strokes.Stroke, without their materials
    fits: list  # 'tight' or 'drawn', of each
    snap: float

    def for_native(self):
        return [{"points": stroke.points, "fit": fit} for stroke, fit in zip(self.strokes, self.fits, strict=True)]


def drawn_layout(context, surface):
    """The layout of a mesh object, made if there is none, ready to be drawn in; raises LayoutInputError."""
    layout = properties.drawn_on(surface, context)
    if layout is None:
        layout = _new_object(context, surface, "DRAWN", ".layout", _DRAWING_INKS)
    elif not objects.is_local(layout) or not objects.is_local(layout.data):
        raise LayoutInputError(f"{layout.name} comes from a library and cannot be drawn in; make it local, or remove it from the scene")
    _add_inks(layout, _DRAWING_INKS)
    placement.show(context, layout, surface)
    frame = context.scene.frame_current
    layers = layout.data.layers
    if layers.active is None or not _can_be_drawn_in(layers.active):
        found = [layer for layer in layers if _can_be_drawn_in(layer)]
        layers.active = found[-1] if found else _new_layer(context, layout)
    if not strokes.has_frame(layers.active, frame):
        layers.active.frames.new(frame)
    return layout


def read_drawn(context, surface):
    """What is Drawn on a mesh object; raises LayoutInputError or StrokeError."""
    layout = properties.drawn_on(surface, context)
    if layout is None:
        raise LayoutInputError(f"{surface.name} has no layout; Draw Layout makes one")
    try:
        found = strokes.read(layout, context.scene.frame_current)
    except arrays.MatrixError as error:
        raise LayoutInputError(f"{layout.name} has a scale of zero in a direction; give it another one") from error
    if not found:
        raise LayoutInputError(f"Nothing is drawn in {layout.name} that is visible at frame {context.scene.frame_current}")
    kept = [replace(stroke, material=None) for stroke in found]
    return Drawn(objects.key_of(layout), kept, [fit_of(stroke) for stroke in found], layout.hybrid_mesh_layout.snap)


def has_strokes(context, surface):
    """Whether anything is drawn on a mesh object that is visible at the present frame."""
    layout = properties.drawn_on(surface, context)
    try:
        return layout is not None and bool(strokes.read(layout, context.scene.frame_current))
    except arrays.MatrixError:
        return True  # read_drawn() says what is wrong.


def fit_of(stroke):
    """'tight' or 'drawn', as the material says that the stroke is drawn in."""
    return "drawn" if stroke.material is not None and stroke.material.get(FIT) == "drawn" else "tight"


def show_curves(context, surface, result, size):
    """Puts a layout's curves and nodes into an object of their own, in place of earlier ones. size: the bounding-box diagonal."""
    shown = _emptied(context, surface, "CURVES", ".layout curves", ("curve", "node"))
    frame = context.scene.frame_start
    lines = [numpy.asarray(curve["points"]) for curve in result["curves"]]
    strokes.write(shown, strokes.add_layer(shown, "Curves", frame), frame, lines, 0, 4, _LINE_RADIUS * size)
    nodes = [line for node in result["nodes"] for line in _cross(node, _NODE_SIZE * size)]
    strokes.write(shown, strokes.add_layer(shown, "Nodes", frame), frame, nodes, 1, 6, 1.5 * _LINE_RADIUS * size)


def show_problems(context, surface, layout, drawn, problems, size):
    """Marks problems, in place of earlier ones, and lists them with the layout. drawn: the strokes that were read."""
    forget_problems(context, surface, layout)
    if not problems:
        return
    to_layout = numpy.linalg.inv(numpy.array(layout.matrix_world, dtype=float))
    lines, dots = [], []
    for problem in problems:
        entry = layout.hybrid_mesh_layout.problems.add()
        entry.kind, entry.message = str(problem.get("kind", "")), str(problem.get("message", ""))
        stroke = problem.get("stroke", -1)
        if 0 <= stroke < len(drawn):
            entry.layer, entry.number = drawn[stroke].layer, drawn[stroke].number
        points = numpy.asarray(problem.get("points", ()), dtype=float).reshape(-1, 3)
        points = points[numpy.isfinite(points).all(axis=1)]
        if not len(points) and 0 <= stroke < len(drawn):
            points = drawn[stroke].points[numpy.isfinite(drawn[stroke].points).all(axis=1)]
        if not len(points):
            continue
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        entry.place = to_layout[:3, :3] @ middle + to_layout[:3, 3]
        entry.size = max(float(numpy.linalg.norm(numpy.ptp(points, axis=0))), _MARK_SIZE * size)
        if numpy.linalg.norm(numpy.ptp(points, axis=0)) < _MARK_SIZE * size:
            dots += _cross(middle, _MARK_SIZE * size)
        else:
            lines.append(points)
    if not lines and not dots:
        return
    shown = _emptied(context, surface, "PROBLEMS", ".layout problems", ("problem",))
    shown.show_in_front = True
    frame = context.scene.frame_start
    strokes.write(shown, strokes.add_layer(shown, "Problems", frame), frame, lines + dots, 0, 10, _MARK_RADIUS * size)


def forget_problems(context, surface, layout):
    layout.hybrid_mesh_layout.problems.clear()
    layout.hybrid_mesh_layout.problem_index = 0
    marks = properties.layout_of(surface, context.scene, "PROBLEMS")
    if marks is not None:
        data = marks.data
        bpy.data.objects.remove(marks)
        if not data.users:
            compat.grease_pencils().remove(data)


def hide(context, surface):
    """Hides the layout of a mesh object and what was made of it."""
    for kind in ("DRAWN", "CURVES", "PROBLEMS"):
        obj = properties.layout_of(surface, context.scene, kind)
        if obj is not None and objects.in_view_layer(obj, context.view_layer):
            obj.hide_set(True)


def _cross(place, size):
    return [numpy.stack([place - step, place + step]) for step in numpy.eye(3) * size / 2]


def _ink(key):
    for material in bpy.data.materials:
        if material.get(_INK) == key and material.library is None and material.grease_pencil is not None:
            return material
    material = strokes.new_ink(*_INKS[key])
    material[_INK] = key
    if key in _DRAWING_INKS:
        material[FIT] = key
    return material


def _add_inks(obj, keys):
    """Adds the inks that an object has lost."""
    found = {slot.material.get(_INK) for slot in obj.material_slots if slot.material is not None}
    for key in keys:
        if key not in found:
            obj.data.materials.append(_ink(key))


def _can_be_drawn_in(layer):
    return not strokes.is_hidden(layer) and not strokes.is_locked(layer)


def _new_layer(context, layout):
    # From the scene's first frame on: the strokes then stay in view at all others.
    layer = strokes.add_layer(layout, _LAYER, min(context.scene.frame_current, context.scene.frame_start))
    if hasattr(layer, "line_change"):
        layer.line_change = _THINNER
    return layer


def _emptied(context, surface, kind, suffix, inks):
    obj = properties.layout_of(surface, context.scene, kind)
    if obj is None:
        obj = _new_object(context, surface, kind, suffix, inks)
    strokes.remove_layers(obj)
    placement.show(context, obj, surface)
    return obj


def _new_object(context, surface, kind, suffix, inks):
    obj = strokes.new_object(with_suffix(surface.name, suffix), placement.collection_beside(context, surface), [_ink(key) for key in inks])
    obj.hybrid_mesh_layout.kind = kind
    obj.hybrid_mesh_layout.surface = surface
    obj.hide_render = True
    placement.go_with(context, obj, surface)
    return obj
