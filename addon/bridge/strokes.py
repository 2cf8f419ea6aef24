# SPDX-License-Identifier: GPL-3.0-or-later
"""Grease Pencil strokes as polylines in world space, and back: one adapter for both data models, that of Blender 3.4 - 4.2 and that of 4.3 and later.

World space needs up-to-date matrices: where objects have just been made or moved, update the view layer first."""

from dataclasses import dataclass

import bpy
import numpy
from mathutils import Euler, Matrix

from .. import compat
from .arrays import transformed, world_matrix
from .splines import bezier, catmull_rom, closed

# As Blender keeps them; a drawing without the attribute has the first kind only.
_CATMULL_ROM, _POLY, _BEZIER, _NURBS = range(4)
_DEFAULT_RESOLUTION = 12
_DEFAULT_RADIUS = 0.01


class StrokeError(ValueError):
    """A stroke that cannot be read; the message says which and why."""


@dataclass
class Stroke:
    points: numpy.ndarray  # float64 (n, 3) in world space; where the stroke is closed, the first point is also the last
    material: bpy.types.Material  # or None
    layer: str
    number: int  # in its layer's drawing


def is_grease_pencil(obj):
    return obj is not None and obj.type in {"GPENCIL", "GREASEPENCIL"}


def draw_mode(obj):
    """The mode in which strokes are drawn into a Grease Pencil object."""
    return "PAINT_GPENCIL" if obj.type == "GPENCIL" else "PAINT_GREASE_PENCIL"


def new_object(name, collection, materials=()):
    """A Grease Pencil object without layers, linked to a collection."""
    obj = bpy.data.objects.new(name, compat.grease_pencils().new(name))
    if obj.type == "GPENCIL":
        obj.data.stroke_thickness_space = "SCREENSPACE"
    collection.objects.link(obj)
    for material in materials:
        obj.data.materials.append(material)
    return obj


def new_ink(name, color):
    """A material that draws strokes in a colour (linear RGBA) and fills nothing."""
    material = bpy.data.materials.new(name)
    bpy.data.materials.create_gpencil_data(material)
    material.grease_pencil.color = color
    material.grease_pencil.show_stroke = True
    material.grease_pencil.show_fill = False
    material.diffuse_color = color  # in Solid shading
    return material


def add_layer(obj, name, frame):
    """A layer with an empty drawing from a frame on; it becomes the active one."""
    layer = obj.data.layers.new(name, set_active=True)
    layer.frames.new(frame)
    return layer


def remove_layers(obj):
    for layer in list(obj.data.layers):
        obj.data.layers.remove(layer)


def has_frame(layer, frame):
    """Whether a layer shows a drawing at a frame of the scene."""
    return _frame_at(layer, frame) is not None


def is_hidden(layer):
    """Hidden itself or in a group that is."""
    return _any_above(layer, "hide")


def is_locked(layer):
    """Locked itself or in a group that is."""
    return _any_above(layer, "lock")


def layer_matrix(obj, layer):
    """From a layer's space to the world."""
    if hasattr(layer, "matrix_local"):
        own, inverse, bone = layer.matrix_local, layer.matrix_parent_inverse, layer.parent_bone
    else:
        own = Matrix.LocRotScale(layer.location, Euler(layer.rotation), layer.scale)
        inverse, bone = layer.matrix_inverse, layer.parent_bone if layer.parent_type == "BONE" else ""
    matrix = numpy.array(own, dtype=numpy.float64)
    if layer.parent is None:
        return world_matrix(obj.matrix_world) @ matrix
    parent = numpy.array(layer.parent.matrix_world, dtype=numpy.float64)
    if bone and layer.parent.pose is not None and bone in layer.parent.pose.bones:
        parent = parent @ numpy.array(layer.parent.pose.bones[bone].matrix, dtype=numpy.float64)
    return parent @ numpy.array(inverse, dtype=numpy.float64) @ matrix


def read(obj, frame):
    """The strokes that an object shows at a frame of the scene: of visible layers, in visible materials, before modifiers. Changes nothing.

    Raises StrokeError where one cannot be read.
    """
    strokes = []
    for layer in obj.data.layers:
        shown = None if is_hidden(layer) else _frame_at(layer, frame)
        if shown is None:
            continue
        name, matrix = _layer_name(layer), layer_matrix(obj, layer)
        for number, (points, slot) in enumerate(_lines(shown, name)):
            material = obj.material_slots[slot].material if 0 <= slot < len(obj.material_slots) else None
            if material is None or material.grease_pencil is None or not material.grease_pencil.hide:
                strokes.append(Stroke(transformed(points, matrix), material, name, number))
    return strokes


def write(obj, layer, frame, lines, slot=0, pixels=4, radius=_DEFAULT_RADIUS, cyclic=False):
    """Adds polylines ((n, 3) points each, world space) to what a layer shows at a frame.

    slot: of the material; thickness: `pixels` up to Blender 4.2, later the `radius`, a length in the layer's space; cyclic: each is closed.
    """
    lines = [numpy.asarray(line, dtype=numpy.float64).reshape(-1, 3) for line in lines]
    lines = [line for line in lines if len(line)]
    if not lines:
        return
    shown = _frame_at(layer, frame)
    if shown is None:
        raise StrokeError(f"the layer {_layer_name(layer)} has no drawing at frame {frame}")
    inverse = numpy.linalg.inv(layer_matrix(obj, layer))
    lines = [transformed(line, inverse).astype(numpy.float32) for line in lines]
    if hasattr(shown, "drawing"):
        _write_drawing(shown.drawing, lines, slot, radius, cyclic)
    else:
        for line in lines:
            stroke = shown.strokes.new()
            stroke.points.add(len(line))
            stroke.points.foreach_set("co", line.ravel())
            stroke.line_width, stroke.material_index, stroke.use_cyclic = pixels, slot, cyclic
    obj.data.update_tag()


def select(obj, frame, layer_name, number):
    """Selects one stroke and no other; returns whether there is such a stroke."""
    found = False
    for layer in obj.data.layers:
        shown = _frame_at(layer, frame)
        for position, stroke in enumerate(() if shown is None else _strokes(shown)):
            stroke.select = _layer_name(layer) == layer_name and position == number
            found = found or stroke.select
    obj.data.update_tag()
    return found


def remove(obj, frame, chosen):
    """Removes strokes: (layer name, number) of each, as read() tells them."""
    chosen = set(chosen)
    for layer in obj.data.layers:
        shown = _frame_at(layer, frame)
        if shown is None:
            continue
        numbers = sorted(number for name, number in chosen if name == _layer_name(layer) and number < len(_strokes(shown)))
        if hasattr(shown, "drawing"):
            if numbers:
                shown.drawing.remove_strokes(indices=numbers)
        else:
            for stroke in [shown.strokes[number] for number in numbers]:
                shown.strokes.remove(stroke)
    obj.data.update_tag()


def _layer_name(layer):
    return layer.info if hasattr(layer, "info") else layer.name


def _any_above(layer, name):
    while layer is not None:
        if getattr(layer, name):
            return True
        layer = getattr(layer, "parent_group", None)
    return False


def _frame_at(layer, number):
    """The frame that a layer shows at a frame of the scene, or None."""
    if hasattr(layer, "get_frame_at"):
        frame = layer.get_frame_at(number)
        return frame if frame is not None and frame.drawing is not None else None
    return max((frame for frame in layer.frames if frame.frame_number <= number), key=lambda frame: frame.frame_number, default=None)


def _strokes(frame):
    return frame.drawing.strokes if hasattr(frame, "drawing") else frame.strokes


def _lines(frame, layer_name):
    """(points, material slot) of each stroke, in the layer's space."""
    if hasattr(frame, "drawing"):
        yield from _drawing_lines(frame.drawing, layer_name)
        return
    for stroke in frame.strokes:
        points = numpy.empty(3 * len(stroke.points), dtype=numpy.float32)
        stroke.points.foreach_get("co", points)
        yield closed(points.reshape(-1, 3).astype(numpy.float64), stroke.use_cyclic), stroke.material_index


def _drawing_lines(drawing, layer_name):
    offsets = _offsets(drawing)
    count, total = len(offsets) - 1, int(offsets[-1])
    points = _values(drawing, "position", "vector", total, 3, 0).astype(numpy.float64)
    cyclic = _values(drawing, "cyclic", "value", count, 1, 0)
    kinds = _values(drawing, "curve_type", "value", count, 1, _CATMULL_ROM)
    resolutions = _values(drawing, "resolution", "value", count, 1, _DEFAULT_RESOLUTION)
    slots = _values(drawing, "material_index", "value", count, 1, 0)
    left, right = (_values(drawing, name, "vector", total, 3, 0) for name in ("handle_left", "handle_right"))
    has_handles = "handle_left" in drawing.attributes and "handle_right" in drawing.attributes
    for number in range(count):
        part = slice(offsets[number], offsets[number + 1])
        kind, resolution, is_cyclic = kinds[number], int(resolutions[number]), bool(cyclic[number])
        if kind == _CATMULL_ROM:
            line = catmull_rom(points[part], is_cyclic, resolution)
        elif kind == _BEZIER and has_handles:
            line = bezier(points[part], left[part], right[part], is_cyclic, resolution)
        elif kind == _NURBS:
            raise StrokeError(f"stroke {number + 1} of the layer {layer_name} is a NURBS curve; convert it to another curve type")
        else:  # Bezier curves without handles are shown as polylines, too.
            line = closed(points[part], is_cyclic)
        yield line, int(slots[number])


def _offsets(drawing):
    """Where each stroke's points begin, and where the last one's end."""
    offsets = numpy.zeros(len(drawing.strokes) + 1, dtype=numpy.int32)
    if len(offsets) > 1:  # A drawing without strokes has no array of them.
        drawing.curve_offsets.foreach_get("value", offsets)
    return offsets


def _values(drawing, name, field, count, width, default):
    """An attribute of a drawing as an array, a row an element where it has several numbers; `default` everywhere where it is missing."""
    attribute = drawing.attributes.get(name)
    if attribute is None or len(attribute.data) != count:
        values = numpy.full(count * width, default, dtype=numpy.float32)
    else:
        dtype = {"FLOAT": numpy.float32, "FLOAT_VECTOR": numpy.float32, "BOOLEAN": bool}.get(attribute.data_type, numpy.int32)
        values = numpy.empty(count * width, dtype=dtype)
        attribute.data.foreach_get(field, values)
    return values.reshape(-1, width) if width > 1 else values


def _write_drawing(drawing, lines, slot, radius, cyclic):
    strokes, points = len(drawing.strokes), int(_offsets(drawing)[-1])
    drawing.add_strokes([len(line) for line in lines])
    added = sum(map(len, lines))
    _set_new(drawing, "position", "FLOAT_VECTOR", "POINT", points, numpy.concatenate(lines), 0)
    _set_new(drawing, "radius", "FLOAT", "POINT", points, numpy.full(added, radius, dtype=numpy.float32), _DEFAULT_RADIUS)
    _set_new(drawing, "opacity", "FLOAT", "POINT", points, numpy.ones(added, dtype=numpy.float32), 1)
    _set_new(drawing, "curve_type", "INT8", "CURVE", strokes, numpy.full(len(lines), _POLY, dtype=numpy.int32), _CATMULL_ROM)
    _set_new(drawing, "material_index", "INT", "CURVE", strokes, numpy.full(len(lines), slot, dtype=numpy.int32), 0)
    _set_new(drawing, "cyclic", "BOOLEAN", "CURVE", strokes, numpy.full(len(lines), cyclic, dtype=bool), 0)
    drawing.tag_positions_changed()


def _set_new(drawing, name, kind, domain, first, new, default):
    """Sets an attribute of the elements from `first` on; those before keep theirs, or the default that the missing attribute stood for."""
    width = 3 if kind == "FLOAT_VECTOR" else 1
    field = "vector" if width == 3 else "value"
    values = _values(drawing, name, field, first + len(new), width, default).astype(new.dtype)
    attribute = drawing.attributes.get(name)
    if attribute is None:
        attribute = drawing.attributes.new(name, kind, domain)
    values[first:] = new
    attribute.data.foreach_set(field, values.ravel())
