# SPDX-License-Identifier: GPL-3.0-or-later
import math

import bpy
import numpy
import pytest

from layout_tools import PLACES, parented, read, strokes, vector


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("under_parent", [False, True])
def test_strokes_come_back_where_they_were_written(world, place, under_parent):
    obj = strokes().new_object("drawn", bpy.context.scene.collection, [strokes().new_ink("ink", (0, 0, 0, 1))])
    world.placed(obj, **place)
    if under_parent:
        parented(world, obj)
    layer = strokes().add_layer(obj, "one", 1)
    rng = numpy.random.default_rng(3)
    middle, size = numpy.array(obj.matrix_world.translation), max(map(abs, obj.matrix_world.to_scale()))
    lines = [middle + size * rng.normal(size=(count, 3)) for count in (5, 1, 30)]
    strokes().write(obj, layer, 1, lines[:2])
    strokes().write(obj, layer, 1, lines[2:])
    found = strokes().read(obj, 1)
    assert [(one.layer, one.number, one.material.name) for one in found] == [("one", number, "ink") for number in range(3)]
    for line, one in zip(lines, found, strict=True):
        assert one.points.dtype == numpy.float64
        assert abs(one.points - line).max() < 1e-5 * (size + abs(middle).max())


def test_layers_have_transforms_and_parents_of_their_own(world):
    obj = world.placed(strokes().new_object("drawn", bpy.context.scene.collection), location=(1, 2, 3), scale=(1, 2, 0.5), rotation_euler=(0.3, 0, 1))
    layer = strokes().add_layer(obj, "moved", 1)
    local = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], dtype=float)
    strokes().write(obj, layer, 1, [numpy.array([obj.matrix_world @ vector(p) for p in local])])
    setattr(layer, "translation" if hasattr(layer, "translation") else "location", (0, 0, 4))
    layer.rotation, layer.scale = (0, 0, math.pi / 2), (2, 1, 1)
    bpy.context.view_layer.update()
    moved = numpy.array([[0, 0, 4], [0, 2, 4], [-1, 0, 4.5]])
    assert abs(read(obj)[0] - [obj.matrix_world @ vector(p) for p in moved]).max() < 1e-5
    other = bpy.data.objects.new("other", None)
    bpy.context.scene.collection.objects.link(other)
    other.location, other.scale = (10, 0, 0), (1, 1, 3)
    layer.parent = other
    bpy.context.view_layer.update()
    inverse = numpy.array(layer.matrix_parent_inverse if hasattr(layer, "matrix_parent_inverse") else layer.matrix_inverse)
    expected = [numpy.array(other.matrix_world) @ inverse @ [*point, 1] for point in moved]
    assert abs(read(obj)[0] - numpy.array(expected)[:, :3]).max() < 1e-5


def test_closed_strokes_end_where_they_begin(world):
    obj = world.placed(strokes().new_object("drawn", bpy.context.scene.collection))
    layer = strokes().add_layer(obj, "one", 1)
    square = numpy.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    strokes().write(obj, layer, 1, [square])
    strokes().write(obj, layer, 1, [square + 3], cyclic=True)
    opened, closed = read(obj)
    assert numpy.array_equal(opened, square) and numpy.array_equal(closed, numpy.concatenate([square, square[:1]]) + 3)


def test_what_is_not_shown_is_not_read(world):
    ink = strokes().new_ink("ink", (0, 0, 0, 1))
    obj = world.placed(strokes().new_object("drawn", bpy.context.scene.collection, [ink]))
    first, second = strokes().add_layer(obj, "one", 1), strokes().add_layer(obj, "two", 5)
    strokes().write(obj, first, 1, [numpy.zeros((2, 3))])
    strokes().write(obj, second, 5, [numpy.ones((2, 3))])
    first.frames.new(8)
    count = {frame: len(strokes().read(obj, frame)) for frame in (0, 1, 4, 5, 7, 8, 100)}
    assert count == {0: 0, 1: 1, 4: 1, 5: 2, 7: 2, 8: 1, 100: 1}
    second.hide = True
    assert len(strokes().read(obj, 5)) == 1
    ink.grease_pencil.hide = True
    assert strokes().read(obj, 5) == []
    strokes().remove_layers(obj)
    assert strokes().read(obj, 5) == [] and not len(obj.data.layers)


def test_one_stroke_is_selected(world):
    obj = world.placed(strokes().new_object("drawn", bpy.context.scene.collection))
    layer = strokes().add_layer(obj, "one", 1)
    strokes().write(obj, layer, 1, [numpy.zeros((2, 3)), numpy.ones((3, 3))])
    assert strokes().select(obj, 1, "one", 1)
    frame = layer.get_frame_at(1) if hasattr(layer, "get_frame_at") else layer.frames[0]
    assert [stroke.select for stroke in (frame.drawing.strokes if hasattr(frame, "drawing") else frame.strokes)] == [False, True]
    assert not strokes().select(obj, 1, "one", 2) and not strokes().select(obj, 1, "no", 0)


def test_curves_are_sampled_and_stay_curves(world):
    obj = world.placed(strokes().new_object("drawn", bpy.context.scene.collection))
    layer = strokes().add_layer(obj, "one", 1)
    ring = numpy.stack([numpy.cos(numpy.arange(8) * math.pi / 4), numpy.sin(numpy.arange(8) * math.pi / 4), numpy.zeros(8)], axis=1)
    strokes().write(obj, layer, 1, [ring, ring[:5], ring])
    drawing_of = getattr(layer.frames[0], "drawing", None)
    if drawing_of is None:
        assert bpy.app.version < (4, 3, 0)  # where strokes are nothing but polylines
        return
    drawing_of.strokes[0].cyclic = True
    drawing_of.set_types(type="CATMULL_ROM", indices=(0,))
    drawing_of.set_types(type="BEZIER", indices=(1,))
    k = 4 / 3 * math.tan(math.pi / 16)
    for number, point in enumerate(drawing_of.strokes[1].points):
        tangent = numpy.array([-ring[number, 1], ring[number, 0], 0])
        point.handle_left.position, point.handle_right.position = ring[number] - k * tangent, ring[number] + k * tangent
    smooth, half, polygon = read(obj)
    assert len(smooth) > 8 * 8 and numpy.array_equal(smooth[0], smooth[-1]) and len(half) > 4 * 8
    assert abs(numpy.linalg.norm(smooth, axis=1) - 1).max() < 0.01 and abs(numpy.linalg.norm(half, axis=1) - 1).max() < 1e-3
    assert abs(half[-1] - ring[4]).max() < 1e-6 and abs(polygon - ring).max() < 1e-6
    assert [stroke.curve_type for stroke in drawing_of.strokes] == [0, 2, 1] and len(drawing_of.strokes[0].points) == 8
    drawing_of.set_types(type="NURBS", indices=(2,))
    with pytest.raises(strokes().StrokeError, match="stroke 3 of the layer one is a NURBS"):
        strokes().read(obj, 1)
