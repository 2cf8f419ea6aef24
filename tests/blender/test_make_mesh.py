# SPDX-License-Identifier: GPL-3.0-or-later
"""A level as an ordinary mesh."""

import bpy
import numpy
from conftest import module
from test_level_editing import activate, move, places, refused


def painted(world, **transform):
    """A scan with what a surface carries."""
    scan = world.scan(**transform)
    for name in ("red", "green"):
        scan.data.materials.append(bpy.data.materials.new(name))
    for polygon in scan.data.polygons:
        polygon.material_index = int(polygon.center.x > 0)
    scan.data.uv_layers.new(name="map")
    scan.data.attributes.new("height", "FLOAT", "POINT")
    group = scan.vertex_groups.new(name="top")
    group.add([vertex.index for vertex in scan.data.vertices if vertex.co.z > 0.3], 0.5, "REPLACE")
    return scan


def make(level="SHOWN"):
    assert bpy.ops.hybrid_mesh.make_mesh(level=level) == {"FINISHED"}
    obj = bpy.context.object
    assert bpy.context.selected_objects == [obj] and obj.visible_get() and not obj.hide_render and len(obj.modifiers) == 0
    return obj


def carried(mesh):
    return (
        {attribute.name for attribute in mesh.attributes}, [layer.name for layer in mesh.uv_layers], [material.name for material in mesh.materials],
        [polygon.material_index for polygon in mesh.polygons],
    )  # fmt: skip


def test_it_is_what_the_preview_shows(world):
    scan = painted(world, location=(3, 2, 1), rotation_euler=(0.3, 0.2, 0.1), scale=(1, -2, 0.5))
    collection, levels, preview = world.remesh(scan)
    for number, level in enumerate(levels):
        world.select(preview)
        module("bridge.levels").set_level(preview, number)
        obj = make()
        assert obj.name.split(".")[0] == "scan_quads" and obj.data != level.data
        for one, other in zip(world.evaluated(obj), world.evaluated(preview)):
            assert numpy.array_equal(one, other)
        assert carried(obj.data) == carried(level.data)
        assert {"height", "stretch"} <= carried(obj.data)[0] and "map" in obj.data.uv_layers
        assert [material.name for material in obj.data.materials] == ["red", "green"]
        assert [group.name for group in obj.vertex_groups] == ["top"]
        weights = [[(one.group, one.weight) for one in vertex.groups] for vertex in obj.data.vertices]
        assert weights == [[(one.group, one.weight) for one in vertex.groups] for vertex in level.data.vertices] and any(weights)
        # It is no part of the hierarchy.
        assert obj.name not in collection.objects and obj.name in bpy.context.scene.collection.objects
        assert module("features.levels.properties").hierarchy_of(obj) is None and not bpy.ops.hybrid_mesh.update_levels.poll()


def test_the_final_mesh_whatever_is_shown(world):
    scan = world.scan()
    collection, levels, preview = world.remesh(scan)
    module("bridge.levels").set_level(preview, 0)
    for obj in (scan, preview, levels[1]):
        activate(world, obj)
        final = module("features.levels.kept").at_hand(collection).hierarchy.final_mesh()
        points, offsets, indices = world.evaluated(make("FINAL"))
        assert numpy.array_equal(points, final["points"].astype(numpy.float32)) and numpy.array_equal(indices, final["indices"])


def test_the_final_mesh_of_an_adaptive_one(world):
    collection, _, preview = world.remesh(world.scan(), refinement="ADAPTIVE", vertices=1500)
    world.select(preview)
    final = module("features.levels.kept").at_hand(collection).hierarchy.final_mesh()
    points, offsets, indices = world.evaluated(make("FINAL"))
    assert numpy.array_equal(points, final["points"].astype(numpy.float32)) and numpy.array_equal(indices, final["indices"])


def test_changing_it_changes_no_level(world):
    _, levels, preview = world.remesh(world.scan())
    world.select(preview)
    before = places(levels[-1])
    move(make(), lambda points: points * 2)
    assert numpy.array_equal(places(levels[-1]), before)


def test_it_lies_beside_the_hierarchy(world):
    collection, _, preview = world.remesh(world.scan())
    folder = bpy.data.collections.new("folder")
    bpy.context.scene.collection.children.link(folder)
    bpy.context.scene.collection.children.unlink(collection)
    folder.children.link(collection)
    world.select(preview)
    assert make().users_collection == (folder,)


def test_edit_mode_is_left_with_what_was_edited(world):
    import bmesh

    _, levels, preview = world.remesh(world.scan())
    module("bridge.levels").set_level(preview, 1)
    activate(world, levels[1])
    bpy.ops.object.mode_set(mode="EDIT")
    mesh = bmesh.from_edit_mesh(levels[1].data)
    for vertex in mesh.verts:
        vertex.co.x += 10
    bmesh.update_edit_mesh(levels[1].data)
    assert places(make())[:, 0].min() > 5


def test_undo(world):
    _, _, preview = world.remesh(world.scan())
    world.select(preview)
    bpy.ops.ed.undo_push(message="before")
    before = (sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys()))
    assert bpy.ops.hybrid_mesh.make_mesh("EXEC_DEFAULT", True) == {"FINISHED"}
    bpy.ops.ed.undo()
    assert (sorted(bpy.data.objects.keys()), sorted(bpy.data.meshes.keys())) == before
    bpy.ops.ed.redo()
    assert "scan_quads" in bpy.data.objects


def test_what_is_gone_is_said(world):
    _, levels, preview = world.remesh(world.scan())
    world.select(preview)
    bpy.data.objects.remove(levels[-1])
    refused(bpy.ops.hybrid_mesh.make_mesh, "the object of that level is gone")
    preview.modifiers.clear()
    refused(bpy.ops.hybrid_mesh.make_mesh, "the object of that level is gone")
    assert make("FINAL").data.vertices
