# SPDX-License-Identifier: GPL-3.0-or-later
"""Loops around handles and tunnels: found, drawn, kept in the .blend, and used by a remesh."""

import itertools
import json
import math

import bpy
import numpy
import pytest

from conftest import module
from cube import cube_lines
from layout_tools import PLACES, distance, draw, layout_of, parented, read, state, strokes, tolerance

SMALL_BASE = {"vertices": 3000, "base": "GIVEN", "base_quads": 24}


def plate(world, holes=2, subdivisions=3, name="plate", **transform):
    """A plate of rounded bars with a row of holes, along x from the origin on: its genus is their number. Hole k is in the middle of (4 k + 3, 3, 1)."""
    cells = set(itertools.product(range(2 * holes + 1), range(3), range(1))) - {(2 * k + 1, 1, 0) for k in range(holes)}
    places, faces = {}, []
    for cell in cells:
        for axis, side in itertools.product(range(3), (0, 1)):
            beside = tuple(value + (2 * side - 1) * (i == axis) for i, value in enumerate(cell))
            if beside in cells:
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            corners = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = list(cell)
                corner[axis], corner[u], corner[v] = corner[axis] + side, corner[u] + a, corner[v] + b
                corners.append(places.setdefault(tuple(corner), len(places)))
            faces.append(corners if side else corners[::-1])
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(2 * value for value in place) for place in places], [], faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.modifiers.new("round", "SUBSURF").levels = subdivisions
    return world.placed(obj, **transform)


def loops_of(obj):
    return module("features.topology.properties").loops_of(obj)


def shown(obj):
    return module("features.topology.display").shown_loops(obj)


def find(obj):
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.hybrid_mesh.find_loops() == {"FINISHED"}
    return obj.hybrid_mesh_topology


def points_of(obj, loop):
    points = module("core.loops").from_text(loop.points)
    return module("bridge.arrays").transformed(points, numpy.array(obj.matrix_world, dtype=float))


def report_of(collection):
    return json.loads(collection.hybrid_mesh.report)


def genus(report):
    return [level["genus"] for level in report["levels"]]


def around_bar(obj, hole=0, count=40):
    """A closed stroke around the bar at y = 1 beside a hole, in world space: where the bar goes along x."""
    x = 4 * hole + 3
    turn = numpy.linspace(0, 2 * math.pi, count)
    points = numpy.stack([numpy.full(count, x + 0.0), 1 + 0.9 * numpy.cos(turn), 1 + 0.9 * numpy.sin(turn)], axis=1)
    return module("bridge.arrays").transformed(points, numpy.array(obj.matrix_world, dtype=float))


@pytest.mark.parametrize("place", PLACES)
def test_as_many_loops_as_the_genus(world, place):
    obj = parented(world, plate(world, 2, **place))
    before = state(obj)[:5]
    values = find(obj)
    assert state(obj)[:5] == before
    assert len(values.loops) == 2 and all(loop.level == -1 and loop.use and not loop.drawn for loop in values.loops)
    points, offsets, indices = world.evaluated(obj)
    diagonal = numpy.linalg.norm(numpy.ptp(points, axis=0))
    vertices = {tuple(point) for point in numpy.round(points, 4).tolist()} if diagonal > 1 else None
    for loop in values.loops:
        line = points_of(obj, loop)
        length = numpy.linalg.norm(line - numpy.roll(line, 1, axis=0), axis=1).sum()
        assert loop.length == pytest.approx(length / diagonal, rel=1e-4) and loop.kind in ("HANDLE", "TUNNEL")
        assert distance(world, obj, line) < tolerance(world, obj)
        assert vertices is None or diagonal > 100 or all(tuple(point) in vertices for point in numpy.round(line, 4).tolist())


def test_a_ball_has_none(world):
    scan = world.scan()
    assert not scan.is_property_set("hybrid_mesh_topology") and not len(loops_of(scan))
    assert not len(find(scan).loops) and shown(scan) is None
    world.remesh(scan, vertices=500)


def test_where_loops_cannot_be_looked_for(world):
    obj = plate(world, 1)
    obj.scale = (1, 1, 0)
    with pytest.raises(RuntimeError, match="plate: .*zero"):
        bpy.ops.hybrid_mesh.find_loops()
    obj.scale = (1, 1, 1)
    collection, levels, preview = world.remesh(obj, vertices=500)
    world.select(levels[0])
    levels[0].hide_set(False)
    world.select(levels[0])
    assert not bpy.ops.hybrid_mesh.find_loops.poll()
    # What shows the source stands for it.
    world.select(preview)
    assert bpy.ops.hybrid_mesh.find_loops() == {"FINISHED"} and len(loops_of(obj)) == 1
    world.select(obj)
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.hybrid_mesh.find_loops.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    world.select()
    assert not bpy.ops.hybrid_mesh.find_loops.poll()


def test_loops_are_shown_by_one_curve_object(world):
    obj = plate(world, 2, location=(3, 0, 1), scale=(1, 2, 1))
    values = find(obj)
    curve = shown(obj)
    assert curve.parent == obj and curve.hide_render and curve.hide_select and len(curve.data.splines) == 2
    for spline, loop in zip(curve.data.splines, values.loops):
        places = numpy.array([curve.matrix_world @ point.co.to_3d() for point in spline.points])
        assert spline.use_cyclic_u and numpy.abs(places - points_of(obj, loop)).max() < 1e-5

    def look():
        assert shown(obj) == curve and len(curve.data.splines) == len(values.loops)
        return [(round(spline.points[0].radius, 3), curve.data.materials[spline.material_index].name) for spline in curve.data.splines]

    (thick, name), (thin, same) = look()
    assert thick > thin and name == same
    values.index = 1
    assert [radius for radius, _ in look()] == [thin, thick]
    values.loops[0].level = 3
    assert look()[0][1] != look()[1][1]
    values.loops[0].use = False
    values.loops[1].level = 0
    assert look()[0][1] == look()[1][1] != name
    # It goes where the mesh goes, and one that was deleted comes back.
    obj.location.x += 5
    bpy.context.view_layer.update()
    first = curve.matrix_world @ curve.data.splines[0].points[0].co.to_3d()
    assert numpy.abs(numpy.array(first) - points_of(obj, values.loops[0])[0]).max() < 1e-5
    bpy.data.curves.remove(curve.data)
    values.loops[0].level = 2
    assert shown(obj) is None
    find(obj)
    curve = shown(obj)
    assert curve is not None and sum(one.type == "CURVE" for one in bpy.data.objects) == 1
    assert bpy.ops.hybrid_mesh.remove_loop() == {"FINISHED"} and len(look()) == 1 and values.index == 0
    assert bpy.ops.hybrid_mesh.clear_loops() == {"FINISHED"}
    assert shown(obj) is None and not bpy.data.curves and not bpy.ops.hybrid_mesh.clear_loops.poll() and not bpy.ops.hybrid_mesh.remove_loop.poll()


@pytest.mark.parametrize("place", [{}, PLACES[2], PLACES[3]])
def test_levels_that_are_given(world, place):
    obj = plate(world, 2, **place)
    values = find(obj)
    usual = report_of(world.remesh(obj, **SMALL_BASE)[0])
    values.loops[0].level = max(loop["level"] for loop in usual["topology"]["loops"]) + 1
    report = report_of(world.remesh(obj, **SMALL_BASE)[0])
    opened = [loop["level"] for loop in report["topology"]["loops"]]
    assert opened[0] == values.loops[0].level > opened[1] > 0
    assert genus(report)[0] == 0 and genus(report)[opened[0] - 1] == 1 and genus(report)[-1] == 2
    assert [loop["length"] for loop in report["topology"]["loops"]] == pytest.approx([loop.length for loop in values.loops], rel=1e-4)


def test_a_level_without_room_is_told(world, capfd):
    obj = plate(world, 2, **PLACES[2])
    values = find(obj)
    # Level 1 of a base of a few quads has too few for a tube.
    values.loops[0].level = 1
    collection, _, _ = world.remesh(obj, vertices=3000, base="MIN")
    opened = report_of(collection)["topology"]["loops"][0]["level"]
    told = capfd.readouterr().out
    assert opened > 1 and f"loop 1 opens on level {opened}: there was no room for it on level 1" in told and "loop 2" not in told
    values.loops[0].level = opened
    collection, _, _ = world.remesh(obj, vertices=3000, base="MIN")
    assert report_of(collection)["topology"]["loops"][0]["level"] == opened and "no room" not in capfd.readouterr().out


def test_faces_tell_what_opened_there(world):
    obj = plate(world, 2, location=(3, 0, 1))
    find(obj)
    collection, levels, _ = world.remesh(obj, vertices=3000, base="MIN")
    loops = report_of(collection)["topology"]["loops"]
    assert [loop["number"] for loop in loops] == [1, 2]
    face_numbers = module("bridge.meshes").face_numbers
    plan = json.loads(collection.hybrid_mesh.plan.as_string())
    assert [event["level"] for event in plan["topology"]] == [loop["level"] for loop in loops]
    for level in levels:
        number, opened, depth = face_numbers(level, "opened"), face_numbers(level, "opened_level"), int(level.name.rsplit(".", 1)[1][1:])
        before = level.name.rsplit(".", 1)[1].startswith("M")
        there = {loop["number"]: loop["level"] for loop in loops if loop["level"] < depth or (loop["level"] == depth and not before)}
        assert set(number.tolist()) == {0, *there} and all(set(opened[number == one].tolist()) == {at} for one, at in there.items())
        assert (opened[number == 0] == 0).all()
        irregular = numpy.zeros(len(number), dtype=bool)
        level.data.attributes["irregular"].data.foreach_get("value", irregular)
        assert irregular[number > 0].all()
    # Around each loop, the faces say so.
    middles = numpy.array([tuple(levels[-1].matrix_world @ polygon.center) for polygon in levels[-1].data.polygons])
    for one, loop in enumerate(obj.hybrid_mesh_topology.loops, 1):
        nearest = [numpy.linalg.norm(middles - point, axis=1).argmin() for point in points_of(obj, loop)]
        assert (number[nearest] == one).all()


def test_loops_that_are_left_out_are_in_the_base(world):
    obj = plate(world, 2)
    values = find(obj)
    values.loops[0].use = False
    report = report_of(world.remesh(obj, **SMALL_BASE)[0])
    assert genus(report)[0] == 1 and genus(report)[-1] == 2 and len(report["topology"]["loops"]) == 1
    values.loops[1].level = 0
    report = report_of(world.remesh(obj, **SMALL_BASE)[0])
    assert set(genus(report)) == {2} and not report["topology"]["loops"]


def test_the_plan_names_points_of_the_surface(world):
    obj = plate(world, 2, **PLACES[2])
    values = find(obj)
    source = module("bridge.meshes").read_source(obj, bpy.context.evaluated_depsgraph_get())
    plan = json.loads(module("features.topology.properties").plan_of(obj, source))
    assert sorted(plan) == ["format", "topology", "version"] and ["level" in event for event in plan["topology"]] == [False, False]
    vertices = {tuple(point) for point in source.mesh.points.tolist()}
    assert all(tuple(point) in vertices for event in plan["topology"] for point in event["loops"][0])
    values.loops[0].points = "no points"
    with pytest.raises(RuntimeError, match="plate: a loop's points cannot be read"):
        bpy.ops.hybrid_mesh.remesh(vertices=500)


def test_a_drawn_loop(world):
    obj = plate(world, 2)
    line = around_bar(obj, 1)
    draw(obj, [line, line[:9]])  # the second one is not closed
    assert bpy.ops.hybrid_mesh.draw_loop() == {"FINISHED"}
    values = obj.hybrid_mesh_topology
    assert len(values.loops) == 1 and values.loops[0].drawn and values.loops[0].kind == "HANDLE"
    loop = points_of(obj, values.loops[0])
    assert distance(world, obj, loop) < tolerance(world, obj) and numpy.linalg.norm(loop.mean(axis=0) - line[:-1].mean(axis=0)) < 1
    # The stroke has become the loop, the other one is left; and there is nothing more to do.
    assert len(read(layout_of(obj))) == 1
    with pytest.raises(RuntimeError, match="closed"):
        bpy.ops.hybrid_mesh.draw_loop()
    # Only this hole is closed on the base.
    bpy.ops.object.mode_set(mode="OBJECT")
    report = report_of(world.remesh(obj, **SMALL_BASE)[0])
    assert genus(report)[0] == 1 and genus(report)[-1] == 2
    # What is found beside it leaves it as it is.
    values.loops[0].level = 4
    find(obj)
    assert [loop.drawn for loop in values.loops] == [True, False] and [loop.level for loop in values.loops] == [4, -1]
    assert numpy.abs(points_of(obj, values.loops[0]) - loop).max() < 1e-6


def test_a_loop_drawn_from_two_sides(world):
    obj = plate(world, 2)
    line = around_bar(obj, 1)
    draw(obj, [line[:21], line[:12] + 20, line[20:][::-1]])  # the second one goes on nowhere
    assert bpy.ops.hybrid_mesh.draw_loop() == {"FINISHED"}
    (loop,) = obj.hybrid_mesh_topology.loops
    assert loop.drawn and loop.kind == "HANDLE" and len(read(layout_of(obj))) == 1
    assert numpy.linalg.norm(points_of(obj, loop).mean(axis=0) - line[:-1].mean(axis=0)) < 1


def test_found_loops_give_way_to_drawn_ones(world):
    obj = plate(world, 2)
    values = find(obj)
    middles = [points_of(obj, loop).mean(axis=0) for loop in values.loops]
    values.loops[1].level = 3
    # Around the bar that the first one is around, or another one of the same hole: together they would cut off a piece, or meet.
    x = 0 if middles[0][0] < 5 else 1
    draw(obj, [around_bar(obj, x)])
    assert bpy.ops.hybrid_mesh.draw_loop() == {"FINISHED"}
    drawn = [loop.drawn for loop in values.loops]
    assert drawn[0] and values.index == 0 and sum(drawn) == 1 and 1 <= len(values.loops) <= 2
    assert all(loop.level == 3 or loop.level == -1 for loop in values.loops)
    # Twice the same is refused, and nothing has changed.
    before = [(loop.points, loop.level) for loop in values.loops]
    layout = layout_of(obj)
    strokes().write(layout, layout.data.layers.active, 1, [around_bar(obj, x)])
    with pytest.raises(RuntimeError, match="stroke 1 .*(touches|separates)"):
        bpy.ops.hybrid_mesh.draw_loop()
    assert [(loop.points, loop.level) for loop in values.loops] == before and len(read(layout)) == 1


def test_strokes_that_are_no_loops(world):
    obj = plate(world, 1)
    with pytest.raises(RuntimeError, match="has no layout"):
        bpy.ops.hybrid_mesh.draw_loop()
    turn = numpy.linspace(0, 2 * math.pi, 40)
    # Around nothing: on the top of a bar.
    draw(obj, [numpy.stack([3 + 0.5 * numpy.cos(turn), 1 + 0.5 * numpy.sin(turn), numpy.full(40, 1.9)], axis=1)])
    with pytest.raises(RuntimeError, match="plate: stroke 1"):
        bpy.ops.hybrid_mesh.draw_loop()
    assert not len(loops_of(obj)) and len(read(layout_of(obj))) == 1


def test_the_list_is_saved(world, tmp_path):
    obj = plate(world, 2)
    values = find(obj)
    values.loops[0].level, values.loops[1].use, values.index = 3, False, 1
    before = [(loop.kind, loop.length, loop.points, loop.level, loop.use, loop.drawn) for loop in values.loops]
    path = str(tmp_path / "loops.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects["plate"]
    values = obj.hybrid_mesh_topology
    assert [(loop.kind, loop.length, loop.points, loop.level, loop.use, loop.drawn) for loop in values.loops] == before and values.index == 1
    assert len(shown(obj).data.splines) == 2
    report = report_of(world.remesh(obj, **SMALL_BASE)[0])
    assert genus(report)[0] == 1 and [loop["level"] for loop in report["topology"]["loops"]][0] >= 3


def test_each_is_one_undo_step(world):
    draw(plate(world, 2), [around_bar(bpy.data.objects["plate"])])
    bpy.ops.object.mode_set(mode="OBJECT")
    world.select(bpy.data.objects["plate"])
    bpy.ops.ed.undo_push(message="before")

    def counts():
        obj = bpy.data.objects["plate"]
        return len(loops_of(obj)), sum(one.type == "CURVE" for one in bpy.data.objects), len(read(layout_of(obj)))

    seen = [counts()]
    for operator in (bpy.ops.hybrid_mesh.draw_loop, bpy.ops.hybrid_mesh.find_loops, bpy.ops.hybrid_mesh.remove_loop, bpy.ops.hybrid_mesh.clear_loops):
        assert operator("EXEC_DEFAULT", True) == {"FINISHED"}
        seen.append(counts())
    assert seen == [(0, 0, 1), (1, 1, 0), (2, 1, 0), (1, 1, 0), (0, 0, 0)]
    for expected in seen[-2::-1]:
        bpy.ops.ed.undo()
        assert counts() == expected
    for expected in seen[1:]:
        bpy.ops.ed.redo()
        assert counts() == expected


def test_a_base_that_is_given_wins(world, capfd):
    scan = world.scan()
    draw(scan, cube_lines(scan))
    loop = scan.hybrid_mesh_topology.loops.add()
    loop.points = json.dumps([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    bpy.context.scene.hybrid_mesh.vertices = 500
    assert bpy.ops.hybrid_mesh.remesh_layout() == {"FINISHED"}
    assert len(world.hierarchy(scan)[1][0].data.polygons) == 6
    assert "its loops are not used" in capfd.readouterr().out


def test_a_mesh_of_a_library_keeps_its_loops(world, tmp_path):
    plate(world, 1)
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(path, link=True) as (_, chosen):
        chosen.objects = ["plate"]
    bpy.context.scene.collection.objects.link(chosen.objects[0])
    world.select(chosen.objects[0])
    with pytest.raises(RuntimeError, match="plate comes from a library"):
        bpy.ops.hybrid_mesh.find_loops()
