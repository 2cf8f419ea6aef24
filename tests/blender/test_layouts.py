# SPDX-License-Identifier: GPL-3.0-or-later
import math

import bpy
import numpy
import pytest
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from conftest import module
from cube import cube_lines, on_surface

PLACES = [
    {},
    {"location": (5, -2, 1), "rotation_euler": (0.4, -1.2, 2.5)},
    {"location": (-3, 7, 2), "rotation_euler": (1.1, 0.2, -0.7), "scale": (0.3, 2, 1.1)},
    {"scale": (-1, 1, 2), "rotation_euler": (0, 0.5, 0)},
    {"scale": (2000, 2000, 1500)},
    {"location": (0.01, 0, 0), "scale": (1e-3, 1e-3, 1e-3)},
]


def vector(point):
    return Vector([float(value) for value in point])


def strokes():
    return module("bridge.strokes")


def drawing():
    return module("features.layouts.drawing")


def state(obj):
    """Everything of an object that an operator could have changed."""
    mesh = obj.data
    points = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", points)
    return (
        obj.name, mesh.name, points.tobytes(), tuple(map(tuple, obj.matrix_world)), obj.parent, [one.name for one in obj.modifiers], sorted(obj.keys()),
        [one.name for one in obj.users_collection], obj.hide_get(), len(mesh.attributes), len(mesh.materials), obj.is_property_set("hybrid_mesh"),
        obj.is_property_set("hybrid_mesh_layout"),
    )  # fmt: skip


def parented(world, obj):
    """Puts an object under a turned and stretched parent, so that its world matrix shears."""
    parent = bpy.data.objects.new("parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.location, parent.rotation_euler, parent.scale = (1, 2, 3), (0.3, 0.2, 0.9), (1, 2.5, 0.7)
    obj.parent = parent
    bpy.context.view_layer.update()
    return obj


def broken_cube(obj):
    """A cube with one edge that ends half-way."""
    lines = cube_lines(obj)
    return [*lines[:11], lines[11][:5]]


def diagonal(points):
    return numpy.linalg.norm(numpy.ptp(points, axis=0))


def tolerance(world, obj):
    """What single precision may cost where an object stands."""
    points = world.evaluated(obj)[0]
    return 1e-5 * diagonal(points) + 3e-7 * abs(points).max()


def layout_of(obj, kind="DRAWN"):
    return module("features.layouts.properties").layout_of(obj, bpy.context.scene, kind)


def draw(obj, lines):
    """Draw Layout on an object, and strokes into what it makes."""
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
    layout = layout_of(obj)
    strokes().write(layout, layout.data.layers.active, bpy.context.scene.frame_current, lines)
    return layout


def check():
    assert bpy.ops.hybrid_mesh.check_layout() == {"FINISHED"}


def read(obj):
    return [stroke.points for stroke in strokes().read(obj, bpy.context.scene.frame_current)]


def distance(world, obj, points):
    """The largest distance of points to the surface of an object, in world space."""
    tree_points, offsets, indices = world.evaluated(obj)
    tree = BVHTree.FromPolygons(tree_points.tolist(), [indices[a:b].tolist() for a, b in zip(offsets[:-1], offsets[1:])])
    return max(tree.find_nearest(point.tolist())[3] for point in points)


# --- the adapter -------------------------------------------------------------------------------------------------------------------


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


# --- drawing -----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("place", PLACES)
def test_draw_layout_leaves_the_scan_as_it_is(world, place):
    scan = parented(world, world.scan("Größe 猫", **place))
    before = state(scan)
    layout = draw(scan, [])
    assert state(scan) == before
    assert bpy.context.object == layout and strokes().is_grease_pencil(layout) and layout.mode == strokes().draw_mode(layout)
    assert layout.name == "Größe 猫.layout" and layout.hybrid_mesh_layout.surface == scan
    settings = bpy.context.scene.tool_settings
    assert settings.gpencil_stroke_placement_view3d == "SURFACE"
    assert getattr(settings, "gpencil_surface_offset", 0) == 0 and getattr(layout.data, "zdepth_offset", 0) == 0
    assert numpy.allclose(layout.matrix_world.to_scale(), 1, atol=1e-3) and layout.hide_render
    line = on_surface(scan, [(1, 0, 0), (1, 1, 0), (0, 1, 0)])
    strokes().write(layout, layout.data.layers.active, 1, [line])
    assert distance(world, scan, read(layout)[0]) < tolerance(world, scan)


def test_a_layout_is_found_again(world, tmp_path):
    scan = world.scan()
    layout = draw(scan, [on_surface(scan, [(1, 0, 0), (0, 1, 0)])])
    # From the layout, from the scan, with other names, hidden, out of view, at another frame.
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"} and layout_of(scan) == layout
    bpy.ops.object.mode_set(mode="OBJECT")
    scan.name, layout.name = "renamed", "other"
    layout.hide_set(True)
    bpy.context.scene.frame_set(-20)
    world.select(scan)
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
    assert layout_of(scan) == layout == bpy.context.object and layout.visible_get()
    assert strokes().has_frame(layout.data.layers.active, -20)
    assert sum(strokes().is_grease_pencil(obj) for obj in bpy.data.objects) == 1
    bpy.context.scene.frame_set(30)
    path = str(tmp_path / "layout.blend")
    bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    scan = bpy.data.objects["renamed"]
    assert layout_of(scan) == bpy.data.objects["other"] and len(read(layout_of(scan))) == 1
    # A copy of the scan has no layout yet.
    copy = scan.copy()
    bpy.context.scene.collection.objects.link(copy)
    assert layout_of(copy) is None


def test_a_layout_goes_where_its_scan_goes(world):
    scan = world.scan(scale=(1, 2, 1))
    draw(scan, [on_surface(scan, [(1, 0, 0), (1, 1, 1), (0, 1, 0)])])
    bpy.ops.object.mode_set(mode="OBJECT")
    scan.location, scan.rotation_euler = (4, 5, 6), (0.5, 0.1, 2)
    bpy.context.view_layer.update()
    assert distance(world, scan, read(layout_of(scan))[0]) < 1e-5


def test_what_cannot_be_drawn_on(world):
    flat = world.scan(scale=(1, 1, 0))
    with pytest.raises(RuntimeError, match="zero"):
        bpy.ops.hybrid_mesh.draw_layout()
    assert layout_of(flat) is None and len(bpy.data.objects) == 1
    bpy.ops.object.empty_add()
    with pytest.raises(RuntimeError, match="poll"):
        bpy.ops.hybrid_mesh.draw_layout()
    world.select()
    assert not bpy.ops.hybrid_mesh.draw_layout.poll()


@pytest.mark.parametrize("how", ["eye", "screen", "exclude"])
def test_a_layout_in_a_collection_that_is_not_seen(world, how):
    scan = world.scan()
    layout = draw(scan, [on_surface(scan, [(1, 0, 0), (0, 1, 0)])])
    bpy.ops.object.mode_set(mode="OBJECT")
    other = bpy.data.collections.new("other")
    bpy.context.scene.collection.children.link(other)
    other.objects.link(layout)
    for collection in list(layout.users_collection):
        if collection != other:
            collection.objects.unlink(layout)
    hidden = bpy.context.view_layer.layer_collection.children["other"]
    hidden.hide_viewport, hidden.exclude = how == "eye", how == "exclude"
    other.hide_viewport = how == "screen"
    world.select(scan)
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
    assert layout_of(scan) == layout == bpy.context.object and layout.visible_get() and len(read(layout)) == 1


def test_draw_layout_from_edit_mode(world):
    scan = world.scan()
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.hybrid_mesh.check_layout.poll()
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
    assert scan.mode == "OBJECT" and bpy.context.object == layout_of(scan)


def test_the_ink_says_how_a_stroke_is_fitted(world):
    scan = world.scan()
    layout = draw(scan, [on_surface(scan, [(1, 0, 0), (0, 1, 0)])])
    strokes().write(layout, layout.data.layers.active, 1, [on_surface(scan, [(1, 0, 0), (0, 0, 1)])], slot=1)
    layout.material_slots[1].material.name = "renamed"
    assert [drawing().fit_of(stroke) for stroke in strokes().read(layout, 1)] == ["tight", "drawn"]
    other = world.scan("other")
    draw(other, [])
    assert [slot.material for slot in layout_of(other).material_slots] == [slot.material for slot in layout.material_slots]


def test_hidden_and_locked_layers_are_not_drawn_in(world):
    scan = world.scan()
    layout = draw(scan, [])
    first = layout.data.layers.active
    second = strokes().add_layer(layout, "second", 1)
    for hidden, locked, expected in ((first, second, 3), (first, None, 3)):
        hidden.hide = True
        if locked is not None:
            locked.lock = True
        world.select(scan)
        bpy.ops.hybrid_mesh.draw_layout()
        active = layout.data.layers.active
        assert not active.hide and not active.lock and len(layout.data.layers) == expected


def test_inks_that_were_removed_come_back(world):
    scan = world.scan()
    layout = draw(scan, [])
    inks = [slot.material for slot in layout.material_slots]
    layout.data.materials.pop(index=1)
    bpy.ops.hybrid_mesh.draw_layout()
    assert [slot.material for slot in layout.material_slots] == inks


def reloaded(tmp_path, names, kind):
    """Saves the file, starts an empty one and links what has these names."""
    path = str(tmp_path / "library.blend")
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return linked(path, names, kind)


def linked(path, names, kind):
    with bpy.data.libraries.load(path, link=True) as (_, chosen):
        setattr(chosen, kind, list(names))
    found = list(getattr(chosen, kind))
    for one in found:
        getattr(bpy.context.scene.collection, {"objects": "objects", "collections": "children"}[kind]).link(one)
    bpy.context.view_layer.update()
    return found


@pytest.mark.parametrize("override", [False, True])
def test_a_scan_in_a_collection_of_a_library(world, tmp_path, override):
    scan = world.scan()
    collection = bpy.data.collections.new("scans")
    bpy.context.scene.collection.children.link(collection)
    collection.objects.link(scan)
    bpy.context.scene.collection.objects.unlink(scan)
    (collection,) = reloaded(tmp_path, ["scans"], "collections")
    if override:
        collection = collection.override_hierarchy_create(bpy.context.scene, bpy.context.view_layer)
        bpy.context.view_layer.update()
    scan = collection.objects[0]
    draw(scan, cube_lines(scan))
    check()
    assert layout_of(scan).hybrid_mesh_layout.summary == "8 nodes, 12 curves, 6 faces" and layout_of(scan).visible_get()


def test_a_layout_from_a_library_is_checked_and_not_drawn_in(world, tmp_path):
    scan = world.scan()
    draw(scan, cube_lines(scan))
    scan, layout = reloaded(tmp_path, ["scan", "scan.layout"], "objects")
    world.select(scan)
    objects = set(bpy.data.objects)
    with pytest.raises(RuntimeError, match="scan.layout comes from a library"):
        bpy.ops.hybrid_mesh.draw_layout()
    assert bpy.context.mode == "OBJECT" and bpy.context.object == scan and set(bpy.data.objects) == objects
    check()
    assert layout.hybrid_mesh_layout.summary == "8 nodes, 12 curves, 6 faces"


def test_a_scan_of_a_library_with_the_name_of_another(world, tmp_path):
    world.scan(scale=(2, 2, 2))
    reloaded(tmp_path, [], "objects")
    local = world.scan()
    (other,) = linked(str(tmp_path / "library.blend"), ["scan"], "objects")
    assert local.name == other.name
    for one in (local, other):
        world.select(one)
        draw(one, cube_lines(one))
        check()
        assert layout_of(one).hybrid_mesh_layout.summary == "8 nodes, 12 curves, 6 faces"
        assert max(distance(world, one, line) for line in read(layout_of(one, "CURVES"))) < 0.05
        bpy.ops.object.mode_set(mode="OBJECT")
    world.select(local, other)
    assert bpy.ops.hybrid_mesh.remesh(vertices=500) == {"FINISHED"}
    for one in (local, other):
        _, levels, _ = world.hierarchy(one)
        assert world.distance(one, levels[-1])["hausdorff"] < 0.1


@pytest.mark.parametrize("active", [0, 1])
def test_the_active_one_of_two_layouts_is_used(world, active):
    scan = world.scan()
    layouts = [draw(scan, broken_cube(scan))]
    bpy.ops.object.mode_set(mode="OBJECT")
    layouts.append(layouts[0].copy())
    layouts[1].data = layouts[0].data.copy()
    bpy.context.scene.collection.objects.link(layouts[1])
    strokes().remove_layers(layouts[1])
    strokes().write(layouts[1], strokes().add_layer(layouts[1], "again", 1), 1, cube_lines(scan))
    world.select(layouts[active])
    check()
    assert [bool(layout.hybrid_mesh_layout.summary) for layout in layouts] == [active == 0, active == 1]
    assert bool(len(layouts[active].hybrid_mesh_layout.problems)) == (active == 0)
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"} and bpy.context.object == layouts[active]


# --- checking ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("under_parent", [False, True])
def test_twelve_curves_make_six_quads(world, place, under_parent):
    scan = world.scan(**place)
    if under_parent:
        parented(world, scan)
    before = state(scan)
    layout = draw(scan, cube_lines(scan))
    drawn = read(layout)
    check()
    assert state(scan) == before
    assert all(numpy.array_equal(a, b) for a, b in zip(read(layout), drawn, strict=True))
    values = layout.hybrid_mesh_layout
    assert len(values.problems) == 0 and values.summary == "8 nodes, 12 curves, 6 faces"
    assert layout_of(scan, "PROBLEMS") is None
    shown = strokes().read(layout_of(scan, "CURVES"), 1)
    curves, nodes = ([one for one in shown if one.layer == name] for name in ("Curves", "Nodes"))
    assert len(curves) == 12 and len(nodes) == 8 * 3
    size = diagonal(world.evaluated(scan)[0])
    assert max(distance(world, scan, one.points) for one in curves) < tolerance(world, scan)
    ends = numpy.array([one.points[[0, -1]] for one in curves])
    assert all((numpy.linalg.norm(ends - one.points.mean(axis=0), axis=2) < 1e-4 * size).sum() == 3 for one in nodes)


def test_problems_are_marked_and_named(world):
    scan = world.scan()
    lines = cube_lines(scan)
    dangling = on_surface(scan, [(1, 0.2, 0.1), (1, 0.2, 0.4), (1, 0.1, 0.6)])
    layout = draw(scan, [*lines, dangling])
    check()
    problems = list(layout.hybrid_mesh_layout.problems)
    assert [problem.kind for problem in problems].count("dangling") >= 1
    assert all(problem.message and problem.size > 0 for problem in problems)
    at_ends = [problem for problem in problems if problem.kind == "dangling"]
    places = numpy.array([layout.matrix_world @ vector(problem.place) for problem in at_ends])
    assert min(numpy.linalg.norm(places[:, None] - dangling[[0, -1]], axis=2).ravel()) < 0.1
    marks = layout_of(scan, "PROBLEMS")
    assert marks.show_in_front and marks.material_slots[0].material.grease_pencil.color[0] > 0.5 > marks.material_slots[0].material.grease_pencil.color[1]
    marked = read(marks)
    for place in places:
        assert min(numpy.linalg.norm(line - place, axis=1).min() for line in marked) < 0.1
    # A check of what has been put right takes the marks away.
    remains = len(bpy.data.objects)
    strokes().remove_layers(layout)
    strokes().write(layout, strokes().add_layer(layout, "again", 1), 1, lines)
    check()
    assert len(layout.hybrid_mesh_layout.problems) == 0 and layout_of(scan, "PROBLEMS") is None and len(bpy.data.objects) == remains - 1


def test_checking_again_replaces_what_was_shown(world):
    scan = world.scan()
    draw(scan, broken_cube(scan))
    for _ in range(2):
        check()
        found = {kind: layout_of(scan, kind) for kind in ("DRAWN", "CURVES", "PROBLEMS")}
        assert {obj for obj in bpy.data.objects} == {scan, *found.values()}
        count = {kind: len(read(obj)) for kind, obj in found.items()}, len(found["DRAWN"].hybrid_mesh_layout.problems)
        assert count == ({"DRAWN": 12, "CURVES": count[0]["CURVES"], "PROBLEMS": count[0]["PROBLEMS"]}, count[1]) and count[1] >= 1
    once = count
    check()
    assert ({kind: len(read(layout_of(scan, kind))) for kind in found}, len(layout_of(scan).hybrid_mesh_layout.problems)) == once


def test_crossing_curves_get_a_node(world):
    scan = world.scan()
    angle = numpy.linspace(0, 2 * math.pi, 60)
    c, s, o = numpy.cos(angle), numpy.sin(angle), 0 * angle
    layout = draw(scan, [on_surface(scan, numpy.stack(columns, axis=1)) for columns in ((c, s, o), (o, c, s))])
    check()
    assert layout.hybrid_mesh_layout.summary == "2 nodes, 4 curves, 4 faces"
    problems = [problem.kind for problem in layout.hybrid_mesh_layout.problems]
    assert problems and set(problems) == {"too_few_sides"}


def test_strokes_that_are_no_curves(world):
    scan = world.scan()
    bad = cube_lines(scan)[0].copy()
    bad[2] = numpy.nan
    layout = draw(scan, [*cube_lines(scan), bad, cube_lines(scan)[1] + 50, numpy.zeros((1, 3))])
    check()
    kinds = [(problem.kind, problem.layer, problem.number) for problem in layout.hybrid_mesh_layout.problems]
    assert kinds == [("unusable", "Layout", 12), ("off_surface", "Layout", 13), ("unusable", "Layout", 14)]
    for index in range(3):
        assert bpy.ops.hybrid_mesh.show_problem(index=index) == {"FINISHED"}
    with pytest.raises(RuntimeError, match="no number 3"):
        bpy.ops.hybrid_mesh.show_problem(index=3)
    frame = layout.data.layers.active.frames[0]
    found = frame.drawing.strokes if hasattr(frame, "drawing") else frame.strokes
    assert [stroke.select for stroke in found] == [False] * 14 + [True]


def test_nothing_to_check(world):
    scan = world.scan()
    assert not bpy.ops.hybrid_mesh.check_layout.poll()
    layout = draw(scan, [])
    with pytest.raises(RuntimeError, match="Nothing is drawn"):
        bpy.ops.hybrid_mesh.check_layout()
    strokes().write(layout, layout.data.layers.active, 1, cube_lines(scan))
    layout.data.layers.active.hide = True
    with pytest.raises(RuntimeError, match="Nothing is drawn"):
        bpy.ops.hybrid_mesh.check_layout()
    assert layout_of(scan, "CURVES") is None
    layout.data.layers.active.hide = False
    scan.data.clear_geometry()
    with pytest.raises(RuntimeError, match="no faces"):
        bpy.ops.hybrid_mesh.check_layout()


def test_a_check_is_done_when_it_returns_where_there_is_no_window(world):
    scan = world.scan()
    draw(scan, broken_cube(scan))
    assert bpy.app.background and bpy.ops.hybrid_mesh.check_layout("INVOKE_DEFAULT") == {"FINISHED"}
    assert not module("jobs").running() and layout_of(scan, "CURVES") is not None and len(layout_of(scan).hybrid_mesh_layout.problems)


def test_a_check_that_fails_changes_nothing(world, monkeypatch):
    scan = world.scan()
    layout = draw(scan, broken_cube(scan))
    check()
    problems = [(problem.kind, problem.message) for problem in layout.hybrid_mesh_layout.problems]
    before = {obj: read(obj) for obj in bpy.data.objects if strokes().is_grease_pencil(obj)}, problems, layout.hybrid_mesh_layout.summary, bpy.context.mode

    def refuse(*_):
        raise world.native().InvalidInput("not this one")

    monkeypatch.setattr(world.native(), "start_layout_plan", refuse)
    with pytest.raises(RuntimeError, match="scan: not this one"):
        bpy.ops.hybrid_mesh.check_layout()
    after = [(problem.kind, problem.message) for problem in layout.hybrid_mesh_layout.problems]
    assert after == before[1] and layout.hybrid_mesh_layout.summary == before[2] and bpy.context.mode == before[3]
    assert all(all(map(numpy.array_equal, read(obj), lines)) for obj, lines in before[0].items()) and len(bpy.data.objects) == 1 + len(before[0])


def meanwhile(world, monkeypatch, change):
    """Has something change after the work of a layout has begun."""
    start = world.native().start_layout_plan

    def start_and_change(*given):
        job = start(*given)
        change()
        return job

    monkeypatch.setattr(world.native(), "start_layout_plan", start_and_change)


@pytest.mark.parametrize("operator", ["check_layout", "remesh_layout"])
def test_problems_are_of_the_strokes_that_were_read(world, monkeypatch, operator):
    scan = world.scan()
    layout = draw(scan, [*cube_lines(scan), cube_lines(scan)[0] + 50])
    meanwhile(world, monkeypatch, lambda: strokes().remove_layers(layout))
    if operator == "check_layout":
        check()
    else:
        with pytest.raises(RuntimeError, match="marked in red"):
            bpy.ops.hybrid_mesh.remesh_layout()
    assert [(problem.kind, problem.layer, problem.number) for problem in layout.hybrid_mesh_layout.problems] == [("off_surface", "Layout", 12)]


@pytest.mark.parametrize("kind", [None, "DRAWN"])
def test_what_is_checked_may_go(world, monkeypatch, kind):
    scan = world.scan()
    draw(scan, broken_cube(scan))
    gone = layout_of(scan) if kind else scan
    meanwhile(world, monkeypatch, lambda: bpy.data.objects.remove(gone))
    with pytest.raises(RuntimeError, match="gone"):
        bpy.ops.hybrid_mesh.check_layout()
    assert len(bpy.data.objects) == 1


def test_what_is_flat_is_named(world):
    scan = world.scan()
    layout = draw(scan, broken_cube(scan))
    check()
    layout.scale = (1, 1, 0)
    bpy.context.view_layer.update()
    for operator in (bpy.ops.hybrid_mesh.check_layout, bpy.ops.hybrid_mesh.remesh_layout):
        with pytest.raises(RuntimeError, match="scan: scan.layout has a scale of zero"):
            operator()
    layout.scale, scan.scale = (1, 1, 1), (1, 0, 1)
    bpy.context.view_layer.update()
    for operator in (bpy.ops.hybrid_mesh.check_layout, bpy.ops.hybrid_mesh.remesh_layout):
        with pytest.raises(RuntimeError, match="scan: its scale is zero"):
            operator()
    assert bpy.ops.hybrid_mesh.show_problem(index=0) == {"FINISHED"}


def put_away(obj, how):
    """Takes an object out of view, in one of the ways that there are."""
    collection = bpy.data.collections.new("away")
    bpy.context.scene.collection.children.link(collection)
    for one in obj.users_collection:
        one.objects.unlink(obj)
    collection.objects.link(obj)
    layer = bpy.context.view_layer.layer_collection.children["away"]
    obj.hide_viewport, layer.exclude, layer.hide_viewport, collection.hide_viewport = (how == one for one in ("screen", "exclude", "layer eye", "layer screen"))
    if how == "eye":
        obj.hide_set(True)


@pytest.mark.parametrize("how", ["screen", "exclude", "layer eye", "layer screen", "eye"])
@pytest.mark.parametrize("drawn", [False, True])
def test_modifiers_count_where_the_mesh_is_not_seen(world, tmp_path, how, drawn):
    box = world.box()
    box.modifiers.new("Subdivision", "SUBSURF").levels = 4
    bpy.context.view_layer.update()
    if drawn:
        draw(box, cube_lines(box))
        bpy.ops.object.mode_set(mode="OBJECT")
    put_away(box, how)
    path = str(tmp_path / "away.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    box = bpy.data.objects["box"]
    away = state_of_view(box)
    with module("bridge.objects").evaluated(bpy.context, box) as graph:
        assert len(module("bridge.meshes").read_source(box, graph).mesh.points) == 6 * 4**4 + 2
    assert state_of_view(box) == away
    if drawn:
        bpy.context.view_layer.objects.active = layout_of(box)
        check()
        assert layout_of(box).hybrid_mesh_layout.summary == "8 nodes, 12 curves, 6 faces"
        bpy.context.scene.hybrid_mesh.vertices, bpy.context.scene.hybrid_mesh.hide_source = 500, True
        assert bpy.ops.hybrid_mesh.remesh_layout() == {"FINISHED"}
        assert bpy.context.object.visible_get() and not box.visible_get()


def state_of_view(obj):
    view_layer = bpy.context.view_layer
    return obj.visible_get(), obj.hide_viewport, obj.name in view_layer.objects and obj.hide_get(), [one.name for one in obj.users_collection]


def test_modifiers_and_quads_count(world):
    # A cube of six quads that a modifier makes round: what is drawn on is what is seen.
    box = world.box()
    box.modifiers.new("Subdivision", "SUBSURF").levels = 4
    bpy.context.view_layer.update()
    draw(box, cube_lines(box))
    check()
    assert layout_of(box).hybrid_mesh_layout.summary == "8 nodes, 12 curves, 6 faces"
    shown = [one.points for one in strokes().read(layout_of(box, "CURVES"), 1) if one.layer == "Curves"]
    assert max(distance(world, box, line) for line in shown) < 1e-4 and max(numpy.linalg.norm(line, axis=1).max() for line in shown) < 1.2


def test_drawing_and_checking_are_one_undo_step_each(world):
    lines = broken_cube(world.scan())
    bpy.ops.ed.undo_push(message="before")
    names = [{obj.name for obj in bpy.data.objects}]
    assert bpy.ops.hybrid_mesh.draw_layout("EXEC_DEFAULT", True) == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    layout = layout_of(bpy.data.objects["scan"])
    strokes().write(layout, layout.data.layers.active, 1, lines)
    bpy.ops.ed.undo_push(message="drawn")
    names.append({obj.name for obj in bpy.data.objects})
    assert bpy.ops.hybrid_mesh.check_layout("EXEC_DEFAULT", True) == {"FINISHED"}
    names.append({obj.name for obj in bpy.data.objects})
    assert names[0] < names[1] < names[2]
    bpy.ops.ed.undo()
    assert {obj.name for obj in bpy.data.objects} == names[1]
    layout = layout_of(bpy.data.objects["scan"])
    assert len(read(layout)) == 12 and not len(layout.hybrid_mesh_layout.problems)
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    assert {obj.name for obj in bpy.data.objects} == names[0]
    for _ in range(3):
        bpy.ops.ed.redo()
    assert {obj.name for obj in bpy.data.objects} == names[2]


def test_the_preview_stands_for_its_source(world):
    properties = module("features.layouts.properties")
    scan = world.scan()
    _, levels, preview = world.remesh(scan)
    scene = bpy.context.scene
    assert properties.surface_of(preview, scene) == scan and properties.surface_of(levels[0], scene) == levels[0]
    assert properties.surface_of(None, scene) is None
    bpy.data.objects.remove(preview.hybrid_mesh.hierarchy.hybrid_mesh.source)
    assert properties.surface_of(preview, scene) is None
