# SPDX-License-Identifier: GPL-3.0-or-later
"""The regular levels of a hierarchy as a Multires modifier."""

import bmesh
import bpy
import numpy
import pytest
from conftest import module
from file_tools import export_hmesh, import_hmesh
from mathutils.kdtree import KDTree
from test_level_editing import activate, by_name, edit, move, places, refused
from test_make_mesh import carried, painted
from test_sharp_edges import check_cube, cube, sharp_edges

TURNED = {"location": (3, 2, 1), "rotation_euler": (0.3, 0.2, 0.1), "scale": (1, -2, 0.5)}


def convert(world, *chosen):
    """The Multires objects made of what these objects belong to."""
    for obj in chosen:
        obj.hide_set(False)
    world.select(*chosen)
    assert bpy.ops.hybrid_mesh.convert_to_multires() == {"FINISHED"}
    made = list(bpy.context.selected_objects)
    assert bpy.context.object in made and all([modifier.type for modifier in obj.modifiers] == ["MULTIRES"] for obj in made)
    return made


def evaluated_mesh(obj):
    """A copy of what a modifier makes of a mesh, in the object's space."""
    graph = bpy.context.evaluated_depsgraph_get()
    return bpy.data.meshes.new_from_object(obj.evaluated_get(graph))


def shape(obj):
    """The places of an object's vertices with its modifiers, in its own space."""
    mesh = evaluated_mesh(obj)
    points = module("bridge.meshes").values_of(mesh.vertices, "co", 3)
    bpy.data.meshes.remove(mesh)
    return points


def tree_of(points):
    tree = KDTree(len(points))
    for index, point in enumerate(points):
        tree.insert(point, index)
    tree.balance()
    return tree


def farthest(points, others):
    """How far the farthest of one set of points is from the other, both ways."""
    worst = 0.0
    for one, other in ((points, others), (others, points)):
        tree = tree_of(other)
        worst = max(worst, max(tree.find(point)[2] for point in one))
    return worst


def same_surface(obj, level):
    """Asserts that an object with its modifiers is the mesh of a level: vertex by vertex, and face by face."""
    made = evaluated_mesh(obj)
    points, expected = module("bridge.meshes").values_of(made.vertices, "co", 3), places(level)
    diagonal = numpy.linalg.norm(numpy.ptp(expected, axis=0))
    assert len(points) == len(expected) and len(made.polygons) == len(level.data.polygons)
    assert farthest(points, expected) <= 1e-6 * diagonal
    centres, expected_centres = (module("bridge.meshes").values_of(mesh.polygons, "center", 3) for mesh in (made, level.data))
    assert farthest(centres, expected_centres) <= 2e-6 * diagonal
    bpy.data.meshes.remove(made)


@pytest.mark.parametrize("transform", [{}, TURNED])
def test_every_level_of_a_uniform_one(world, transform):
    collection, levels, preview = world.remesh(world.scan(**transform))
    [obj] = convert(world, preview)
    assert obj.name == "scan_multires" and len(obj.data.vertices) == len(levels[0].data.vertices)
    modifier = obj.modifiers[0]
    assert modifier.total_levels == modifier.levels == modifier.sculpt_levels == modifier.render_levels == len(levels) - 1 >= 2
    same_surface(obj, levels[-1])
    for one, other in zip(world.evaluated(obj), world.evaluated(preview)):
        assert one.shape == other.shape
    assert world.volume(world.evaluated(obj)) == pytest.approx(world.volume(world.evaluated(preview)), rel=1e-5)
    # The base is the level itself, and it is no part of the hierarchy.
    assert numpy.array_equal(places(obj), places(levels[0]))
    properties = module("features.levels.properties")
    assert properties.hierarchy_of(obj) is None and properties.origin_of(obj) == collection and obj.name not in collection.objects


def test_above_the_last_irregular_level(world):
    scan = world.scan()
    _, levels, _ = world.remesh(scan)
    level = by_name(levels)["N1"]
    activate(world, level)
    for polygon in level.data.polygons:
        polygon.select = polygon.index == 0
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    _, levels, preview = world.hierarchy(scan)
    [obj] = convert(world, preview)
    levels = by_name(levels)
    assert "M1" in levels and len(obj.data.vertices) == len(levels["N1"].data.vertices)
    assert obj.modifiers[0].total_levels == len([name for name in levels if name[0] == "N"]) - 2
    same_surface(obj, levels[list(levels)[-1]])


def test_where_handles_open_late(world):
    bpy.ops.mesh.primitive_torus_add(major_segments=48, minor_segments=24, major_radius=1, minor_radius=0.4)
    scan = bpy.context.object
    _, levels, preview = world.remesh(scan, vertices=6000, base="MIN")
    native = module("features.levels.kept").at_hand(preview.hybrid_mesh.hierarchy).hierarchy
    last = max(native.operation(number)["level"] for number in range(native.operation_count))
    assert any(native.operation(number)["opens"] for number in range(native.operation_count))
    [obj] = convert(world, preview)
    assert len(obj.data.vertices) == len(by_name(levels)[f"N{last}"].data.vertices)
    same_surface(obj, levels[-1])


def test_with_boundaries(world):
    scan = world.scan()
    graph = bmesh.new()
    graph.from_mesh(scan.data)
    bmesh.ops.delete(graph, geom=[face for face in graph.faces if face.calc_center_median().z > 0.6], context="FACES")
    graph.to_mesh(scan.data)
    graph.free()
    _, levels, preview = world.remesh(scan)
    [obj] = convert(world, preview)
    same_surface(obj, levels[-1])


def test_it_has_all_that_the_level_has(world):
    _, levels, preview = world.remesh(painted(world, **TURNED))
    [obj] = convert(world, preview)
    assert carried(obj.data) == carried(levels[0].data)
    assert {"height", "stretch", "patch"} <= carried(obj.data)[0] and {"map", "patches"} <= set(carried(obj.data)[1])
    assert [group.name for group in obj.vertex_groups] == ["top"]
    made = evaluated_mesh(obj)
    assert {"map", "patches"} <= {layer.name for layer in made.uv_layers}
    assert {polygon.material_index for polygon in made.polygons} == {0, 1}


def test_sharp_edges_stay_sharp(world):
    _, levels, preview = world.remesh(cube(world), vertices=1200)
    [obj] = convert(world, preview)
    check_cube(obj.data)
    assert len(sharp_edges(obj.data)) == len(sharp_edges(levels[0].data)) > 0
    same_surface(obj, levels[-1])


@pytest.mark.parametrize("faces", ["QUADS", "TRANSITION", "TRIANGLES"])
def test_an_adaptive_one_is_completed(world, capfd, faces):
    scan = painted(world, **TURNED)
    _, levels, preview = world.remesh(scan, refinement="ADAPTIVE", vertices=1500, faces=faces)
    final = levels[-1]
    before = [places(level) for level in levels]
    [obj] = convert(world, preview)
    assert "having been subdivided" in capfd.readouterr().out
    points, expected = shape(obj), places(final)
    assert len(points) > len(expected)
    diagonal = numpy.linalg.norm(numpy.ptp(expected, axis=0))
    # The finest quads, which are small, have stayed; what the others have become is no farther from the scan.
    paths = numpy.array([value.value for value in final.data.attributes["path"].data])
    depth = (numpy.log2(paths) // 2).astype(int)
    finest = {vertex for polygon in final.data.polygons if depth[polygon.index] == depth.max() for vertex in polygon.vertices}
    tree = tree_of(points)
    assert len(finest) > 50 and max(tree.find(expected[vertex])[2] for vertex in finest) <= 1e-6 * diagonal
    assert world.distance(obj, scan)["l2"] <= world.distance(preview, scan)["l2"]
    assert all(numpy.array_equal(places(level), one) for level, one in zip(levels, before))
    assert [group.name for group in obj.vertex_groups] == ["top"] and {"map", "patches"} <= set(carried(obj.data)[1])


def test_an_adaptive_one_whose_last_irregular_level_has_larger_quads(world):
    scan = painted(world)
    collection, _, preview = world.remesh(scan, refinement="ADAPTIVE", vertices=1500, levels=4)
    kept = module("features.levels.kept")
    at_hand = kept.at_hand(collection)
    hierarchy = at_hand.hierarchy.copy()
    finest = hierarchy.level_names[-2]
    level = hierarchy.level(finest)
    depth = (numpy.log2(level["path"]) // 2).astype(int)
    assert depth.min() < depth.max() == int(finest[1:])
    hierarchy.add_cubes(level["quad"][depth == depth.max()][:1])
    built = module("features.levels.hierarchies").build(
        bpy.context, "cubes", kept.Kept(hierarchy, at_hand.matrix), {}, place=module("bridge.placement").same_place(preview), source=scan,
    )  # fmt: skip
    transfer = module("bridge.transfer")
    carry = transfer.Carrier(module("bridge.meshes").read_source(scan, bpy.context.evaluated_depsgraph_get(), transfer.collect))
    for obj, name in zip(built.levels, built.level_names):
        carry(obj, hierarchy.level(name))
    [obj] = convert(world, built.preview)
    assert "top" in obj.vertex_groups and {"map", "patches"} <= set(carried(obj.data)[1]) and {"height", "stretch"} <= carried(obj.data)[0]
    level = next(one for one in built.levels if one.hybrid_mesh.level == obj.hybrid_mesh.made_level)
    assert len(obj.data.vertices) != len(level.data.vertices) and all(len(polygon.vertices) == 4 for polygon in obj.data.polygons)
    weights = [sum(group.weight for group in vertex.groups) for vertex in obj.data.vertices]
    tops = numpy.array([(obj.matrix_world @ vertex.co).z > 0.6 for vertex in obj.data.vertices])
    assert numpy.array(weights)[tops].min() == pytest.approx(0.5, abs=0.01)


def test_an_adaptive_cube_keeps_its_edges(world):
    _, _, preview = world.remesh(cube(world), vertices=1200, refinement="ADAPTIVE")
    [obj] = convert(world, preview)
    check_cube(obj.data)
    points = shape(obj)
    assert numpy.abs(numpy.abs(points).max(axis=1) - 1).max() < 1e-5


@pytest.mark.parametrize("refinement", ["UNIFORM", "ADAPTIVE"])
def test_of_an_imported_stream(world, tmp_path, refinement):
    """There is no source and no map: what is larger goes on by subdivision."""
    _, _, preview = world.remesh(world.scan(), refinement=refinement)
    path = tmp_path / "stream.hmesh"
    export_hmesh(world, preview, path, kind="STREAM")
    _, levels, imported = import_hmesh(world, path)
    finest = levels[list(levels)[-1]]
    [obj] = convert(world, imported)
    if refinement == "UNIFORM":
        same_surface(obj, finest)
    assert world.distance(obj, imported)["l2"] < 2e-3
    # Baked from Multires, for want of a scan.
    assert bpy.ops.hybrid_mesh.bake(source="MULTIRES") == {"FINISHED"}
    world.select(imported)
    refused(bpy.ops.hybrid_mesh.bake, "is not known")


def test_edited_levels_go_along(world):
    _, levels, preview = world.remesh(world.scan())
    activate(world, levels[0])
    edit(levels[0], lambda points: points * (1, 2, 1) + (0, 0, 1))
    [obj] = convert(world, preview)
    same_surface(obj, levels[-1])


def test_after_reopening(world, tmp_path):
    _, levels, preview = world.remesh(world.scan(**TURNED))
    names = preview.name, levels[-1].name
    path = str(tmp_path / "levels.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    module("features.levels.kept").forget()
    bpy.ops.wm.open_mainfile(filepath=path)
    [obj] = convert(world, bpy.data.objects[names[0]])
    same_surface(obj, bpy.data.objects[names[1]])


def test_what_is_sculpted_is_saved(world, tmp_path):
    """A bump as wide as quads of level 2, given to Multires as a sculpted copy."""
    _, _, preview = world.remesh(world.scan())
    [obj] = convert(world, preview)
    sculpted = bpy.data.objects.new("sculpted", evaluated_mesh(obj))
    bpy.context.scene.collection.objects.link(sculpted)
    centre = places(sculpted)[5]
    move(sculpted, lambda points: points + (0, 0, 0.3) * numpy.exp(-((points - centre) ** 2).sum(axis=1, keepdims=True) / 0.02))
    wanted = places(sculpted)
    world.select(sculpted, obj)
    assert bpy.ops.object.multires_reshape(modifier=obj.modifiers[0].name) == {"FINISHED"}
    name, base = obj.name, places(obj)
    path = str(tmp_path / "sculpted.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    obj = bpy.data.objects[name]
    assert numpy.array_equal(places(obj), base)
    assert numpy.abs(shape(obj) - wanted).max() < 1e-5


@pytest.mark.parametrize("hide", ["exclude", "hide_viewport"])
def test_beside_a_hierarchy_that_is_hidden(world, hide):
    collection, levels, _ = world.remesh(world.scan())
    folder = bpy.data.collections.new("folder")
    bpy.context.scene.collection.children.link(folder)
    bpy.context.scene.collection.children.unlink(collection)
    folder.children.link(collection)
    setattr(bpy.context.view_layer.layer_collection.children["folder"], hide, True)
    [obj] = convert(world, bpy.data.objects["scan"])
    same_surface(obj, levels[-1])


def test_several_at_once_and_what_is_refused_among_them(world):
    first, second, third = world.scan("a", 2), world.scan("b", 2, location=(3, 0, 0)), world.scan("c", 2)
    previews = [world.remesh(scan, vertices=400)[2] for scan in (first, second)]
    _, levels, single = world.remesh(third, levels=0, vertices=0)
    assert len(levels) == 1
    made = convert(world, *previews)
    assert {obj.name for obj in made} == {"a_multires", "b_multires"}
    world.select(*previews, single)
    refused(bpy.ops.hybrid_mesh.convert_to_multires, "c hierarchy.*no regular level is left")
    # The others are there all the same.
    assert {obj.name for obj in bpy.context.selected_objects} == {"a_multires.001", "b_multires.001"}
    # And what was made of a hierarchy leads to it.
    assert [obj.name for obj in convert(world, made[0])] == ["a_multires.002"]


def counts():
    kinds = ("objects", "meshes", "collections", "node_groups", "texts", "materials")
    return {kind: sorted(block.name for block in getattr(bpy.data, kind)) for kind in kinds}


def test_what_cannot_be_done_is_said(world, tmp_path):
    collection, levels, preview = world.remesh(world.scan())
    named = by_name(levels)
    before = counts()
    for change, words in (
        (lambda: move(named["N1"], lambda points: points + 1), "N1 was edited"),
        (lambda: levels[0].shape_key_add(name="Basis"), "shape keys"),
    ):
        change()
        world.select(preview)
        refused(bpy.ops.hybrid_mesh.convert_to_multires, words)
        activate(world, named["N1"])
        if "edited" in words:
            assert bpy.ops.hybrid_mesh.reset_level() == {"FINISHED"}
        levels[0].shape_key_clear()
    assert counts() == before
    # The finest level has operations itself.
    native = module("features.levels.kept").at_hand(collection).hierarchy.copy()
    native.add_cubes(native.level(native.level_names[-1])["quad"][:1])
    kept = module("features.levels.kept")
    built = module("features.levels.hierarchies").build(bpy.context, "cubes", kept.Kept(native, numpy.eye(4)), {})
    world.select(built.preview)
    before = counts()
    refused(bpy.ops.hybrid_mesh.convert_to_multires, "has irregular operations: no regular level is left")
    bpy.data.objects.remove(levels[0])
    world.select(preview)
    refused(bpy.ops.hybrid_mesh.convert_to_multires, "the object of N0 is gone")
    world.select()
    assert not bpy.ops.hybrid_mesh.convert_to_multires.poll()


def test_linked_data_is_refused(world, tmp_path):
    collection, _, _ = world.remesh(world.scan())
    path, name = str(tmp_path / "library.blend"), collection.name
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    with bpy.data.libraries.load(path, link=True) as (_, chosen):
        chosen.collections = [name]
    bpy.context.scene.collection.children.link(chosen.collections[0])
    world.select(chosen.collections[0].hybrid_mesh.preview)
    before = counts()
    refused(bpy.ops.hybrid_mesh.convert_to_multires, "comes of a library")
    assert counts() == before


def test_undo_and_redo(world):
    _, levels, preview = world.remesh(world.scan())
    world.select(preview)
    finest = levels[-1].name
    bpy.ops.ed.undo_push(message="before")
    before = counts()
    assert bpy.ops.hybrid_mesh.convert_to_multires("EXEC_DEFAULT", True) == {"FINISHED"}
    after, shape = counts(), world.evaluated(bpy.context.object)
    bpy.ops.ed.undo()
    assert counts() == before
    bpy.ops.ed.redo()
    assert counts() == after
    obj = bpy.data.objects["scan_multires"]
    assert all(numpy.array_equal(one, other) for one, other in zip(world.evaluated(obj), shape))
    same_surface(obj, bpy.data.objects[finest])
