# SPDX-License-Identifier: GPL-3.0-or-later
import math

import bpy
import mathutils
import numpy
import pytest

from conftest import module


def places(obj):
    return module("bridge.meshes").values_of(obj.data.vertices, "co", 3)


def move(obj, change):
    """Changes the places of an object's vertices: change((n, 3) array) -> (n, 3) array."""
    obj.data.vertices.foreach_set("co", numpy.ascontiguousarray(change(places(obj)), dtype=numpy.float32).ravel())
    obj.data.update()


def edit(obj, change):
    """Moves the vertices of the active level, and the others after them."""
    move(obj, change)
    assert bpy.ops.hybrid_mesh.update_levels() == {"FINISHED"}


def turn(angle, axis):
    return numpy.array(mathutils.Matrix.Rotation(angle, 3, axis))


def by_name(levels):
    return {obj.hybrid_mesh.level: obj for obj in levels}


def activate(world, obj):
    obj.hide_set(False)
    world.select(obj)


def refused(operator, words, **settings):
    with pytest.raises(RuntimeError, match=words):
        operator(**settings)


@pytest.fixture
def edited(world):
    """A scan that is moved, turned and mirrored, and its levels by name, N1 the active object."""
    scan = world.scan(location=(3, 2, 1), rotation_euler=(0.3, 0.2, 0.1), scale=(1, -2, 0.5))
    _, levels, preview = world.remesh(scan)
    levels = by_name(levels)
    activate(world, levels["N1"])
    return levels, preview


def test_finer_levels_and_the_preview_follow(world, edited):
    levels, preview = edited
    before = {name: places(obj) for name, obj in levels.items()}
    seen, _, _ = world.evaluated(preview)
    # A turn in world space is none in the space of an object that is scaled unevenly: all is measured in world space.
    matrix = numpy.array(levels["N1"].matrix_world, dtype=float)
    rotation = turn(1.1, "Z")

    def turned(points):
        world_points = points @ matrix[:3, :3].T + matrix[:3, 3]
        return (world_points @ rotation.T - matrix[:3, 3]) @ numpy.linalg.inv(matrix[:3, :3]).T

    edit(levels["N1"], turned)
    for name, obj in levels.items():
        expected = before[name] if name == "N0" else turned(before[name])
        assert numpy.abs(places(obj) - expected).max() < 1e-5, name
    assert numpy.array_equal(places(levels["N0"]), before["N0"])
    after, _, _ = world.evaluated(preview)
    assert numpy.abs(after - seen @ rotation.T).max() < 1e-5


def test_coarser_levels_follow_if_asked(world, edited):
    levels, _ = edited
    before = places(levels["N0"])
    move(levels["N1"], lambda points: points + (0.5, 0, 0))
    assert bpy.ops.hybrid_mesh.update_levels(coarser=True) == {"FINISHED"}
    assert numpy.abs(places(levels["N0"]) - before - (0.5, 0, 0)).max() < 1e-5


def test_far_from_an_edit_nothing_changes(world, edited):
    levels, _ = edited
    finest = list(levels)[-1]
    before = places(levels[finest])
    levels["N1"].data.vertices[5].co.z += 0.1
    levels["N1"].data.update()
    assert bpy.ops.hybrid_mesh.update_levels() == {"FINISHED"}
    changed = (places(levels[finest]) != before).any(axis=1)
    assert 1 < changed.sum() < len(changed) / 3


def test_one_edit_after_the_other(world, edited):
    levels, _ = edited
    finest = levels[list(levels)[-1]]
    before = places(finest)
    edit(levels["N1"], lambda points: points + (0, 0, 1))
    activate(world, levels["N0"])
    edit(levels["N0"], lambda points: points + (0, 0, 1))
    assert numpy.abs(places(finest) - before - (0, 0, 2)).max() < 1e-5


def test_what_was_sculpted_on_a_finer_level_goes_with_an_edit_of_a_coarser_one(world, edited):
    levels, _ = edited
    name = list(levels)[-1]
    finest = levels[name]
    activate(world, finest)
    bump = places(finest)
    bump[7] += (0.3, 0, 0)
    edit(finest, lambda _: bump)
    activate(world, levels["N0"])
    edit(levels["N0"], lambda points: points + (0, 0, 1))
    assert numpy.abs(places(finest) - bump - (0, 0, 1)).max() < 1e-5


def test_edit_mode_is_left(world, edited):
    import bmesh

    levels, _ = edited
    before = places(levels["N2"])
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(levels["N1"].data)
    for vertex in mesh.verts:
        vertex.co.x += 1
    bmesh.update_edit_mesh(levels["N1"].data)
    assert bpy.ops.hybrid_mesh.update_levels() == {"FINISHED"}
    assert bpy.context.mode == "OBJECT"
    assert numpy.abs(places(levels["N2"]) - before - (1, 0, 0)).max() < 1e-5


def test_reset_takes_an_edit_back(world, edited):
    levels, _ = edited
    before = {name: places(obj) for name, obj in levels.items()}
    move(levels["N1"], lambda points: points * 2)
    assert bpy.ops.hybrid_mesh.reset_level() == {"FINISHED"}
    assert all(numpy.array_equal(places(obj), before[name]) for name, obj in levels.items())
    refused(bpy.ops.hybrid_mesh.reset_level, "nothing to take back")


def test_undo_and_redo_restore_every_level(world, edited):
    levels, _ = edited
    names = {name: obj.name for name, obj in levels.items()}
    states = []

    def remember():
        states.append({name: places(bpy.data.objects[obj]) for name, obj in names.items()})

    def is_state(number):
        return all(numpy.array_equal(places(bpy.data.objects[obj]), states[number][name]) for name, obj in names.items())

    remember()
    bpy.ops.ed.undo_push(message="before")
    move(levels["N1"], lambda points: points @ turn(0.5, "X").T)
    bpy.ops.ed.undo_push(message="edited")
    assert bpy.ops.hybrid_mesh.update_levels("EXEC_DEFAULT", True) == {"FINISHED"}
    remember()
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    assert is_state(0)
    bpy.ops.ed.redo()
    bpy.ops.ed.redo()
    assert is_state(1)
    # The hierarchy at hand goes with them.
    bpy.ops.ed.undo()
    bpy.ops.ed.undo()
    world.select(bpy.data.objects[names["N0"]])
    edit(bpy.data.objects[names["N0"]], lambda points: points + (0, 1, 0))
    for name, obj in names.items():
        assert numpy.abs(places(bpy.data.objects[obj]) - states[0][name] - (0, 1, 0)).max() < 1e-5


def test_what_cannot_be_done_is_said(world, edited):
    levels, preview = edited
    refused(bpy.ops.hybrid_mesh.update_levels, "scan.N1 is as it was")
    move(levels["N1"], lambda points: points + 1)
    move(levels["N2"], lambda points: points + 1)
    refused(bpy.ops.hybrid_mesh.update_levels, "scan.N2 was edited, too")
    activate(world, levels["N2"])
    assert bpy.ops.hybrid_mesh.reset_level() == {"FINISHED"}
    activate(world, levels["N1"])
    levels["N1"].data.vertices[0].co.x = math.nan
    refused(bpy.ops.hybrid_mesh.update_levels, "not finite")
    assert bpy.ops.hybrid_mesh.reset_level() == {"FINISHED"}
    levels["N1"].shape_key_add(name="Basis")
    refused(bpy.ops.hybrid_mesh.update_levels, "shape keys")
    levels["N1"].shape_key_clear()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    refused(bpy.ops.hybrid_mesh.update_levels, "vertices, its level has")
    module("features.levels.kept").forget()
    refused(bpy.ops.hybrid_mesh.update_levels, "did not save it")
    world.select(preview)
    assert not bpy.ops.hybrid_mesh.update_levels.poll() and not bpy.ops.hybrid_mesh.reset_level.poll()


def test_an_operation_goes_with_its_surroundings(world):
    scan = world.scan()
    _, levels, _ = world.remesh(scan)
    levels = by_name(levels)
    activate(world, levels["N1"])
    for polygon in levels["N1"].data.polygons:
        polygon.select = polygon.index == 0
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    _, levels, _ = world.hierarchy(scan)
    levels = by_name(levels)
    assert "M1" in levels
    before = {name: places(obj) for name, obj in levels.items()}
    activate(world, levels["N0"])
    rotation = turn(0.9, "Y")
    edit(levels["N0"], lambda points: points @ rotation.T)
    for name, obj in levels.items():
        assert numpy.abs(places(obj) - before[name] @ rotation.T).max() < 1e-5, name
    # M1 is a level of its own, whose operations' quads follow.
    activate(world, levels["N1"])
    move(levels["M1"], lambda points: points + (1, 0, 0))
    refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")
    activate(world, levels["M1"])
    assert bpy.ops.hybrid_mesh.update_levels() == {"FINISHED"}
    assert numpy.abs(places(levels["N1"]) - before["N1"] @ rotation.T - (1, 0, 0)).max() < 1e-5


def reopened(tmp_path):
    path = str(tmp_path / "levels.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    module("features.levels.kept").forget()
    bpy.ops.wm.open_mainfile(filepath=path)


def test_a_reopened_file_goes_on(world, edited, tmp_path):
    levels, _ = edited
    names = {name: obj.name for name, obj in levels.items()}
    bump = places(levels["N2"])
    bump[7] += (0.3, 0, 0)
    activate(world, levels["N2"])
    edit(levels["N2"], lambda _: bump)
    # What was edited and not carried is so still.
    move(levels["N1"], lambda points: points + (0, 0, 1))
    before = {name: places(obj) for name, obj in levels.items()}
    reopened(tmp_path)
    levels = {name: bpy.data.objects[obj] for name, obj in names.items()}
    assert all(numpy.array_equal(places(obj), before[name]) for name, obj in levels.items())
    activate(world, levels["N1"])
    assert bpy.ops.hybrid_mesh.update_levels() == {"FINISHED"}
    assert numpy.abs(places(levels["N2"]) - bump - (0, 0, 1)).max() < 1e-5
    # And once more: what is in the file is what was kept last.
    reopened(tmp_path)
    levels = {name: bpy.data.objects[obj] for name, obj in names.items()}
    activate(world, levels["N0"])
    edit(levels["N0"], lambda points: points + (0, 1, 0))
    assert numpy.abs(places(levels["N2"]) - bump - (0, 1, 1)).max() < 1e-5


def test_no_region_of_edited_levels_is_laid_out_anew(world, edited, tmp_path):
    levels, _ = edited
    name = levels["N1"].name
    levels["N1"].data.polygons[0].select = True
    edit(levels["N1"], lambda points: points + (0, 0, 1))
    refused(bpy.ops.hybrid_mesh.repatch_region, "its levels were edited", layout_kind="AUTOMATIC")
    reopened(tmp_path)
    activate(world, bpy.data.objects[name])
    refused(bpy.ops.hybrid_mesh.repatch_region, "its levels were edited", layout_kind="AUTOMATIC")


def test_a_damaged_hierarchy_in_a_file_is_none(world, edited, tmp_path):
    levels, _ = edited
    name = levels["N1"].name
    path = str(tmp_path / "levels.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    collection = levels["N1"].hybrid_mesh.hierarchy
    data = collection["hybrid_mesh_hierarchy"]
    for damaged in (b"", data[: len(data) // 2], b"\xff" * 1000, "text"):
        del collection["hybrid_mesh_hierarchy"]
        collection["hybrid_mesh_hierarchy"] = damaged
        module("features.levels.kept").forget()
        world.select(bpy.data.objects[name])
        refused(bpy.ops.hybrid_mesh.update_levels, "did not save it")
    del collection["hybrid_mesh_hierarchy"]
    collection["hybrid_mesh_hierarchy"] = data
    refused(bpy.ops.hybrid_mesh.update_levels, "is as it was")
