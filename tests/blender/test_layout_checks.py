# SPDX-License-Identifier: GPL-3.0-or-later
import math

import bpy
import numpy
import pytest

from conftest import module
from cube import cube_lines, on_surface
from layout_tools import PLACES, broken_cube, check, diagonal, distance, draw, layout_of, parented, read, state, strokes, tolerance, vector


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
