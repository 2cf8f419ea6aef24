# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures, vertex groups and shape keys of a source on what was made of its hierarchy."""

import bpy
import numpy
import pytest
from character import FRAMES, at_rest, character
from conftest import module
from test_baking import Surface
from test_level_editing import activate, places, refused
from test_multires import counts

MOST = 0.002  # of the size: how far apart the surfaces may be on average


def rigged(world, scale=1.0, vertices=8000, remesh_in_frame=None, **settings):
    """(source, armature, the object that was made and moves as it does): remeshed at rest, or as it is in a frame."""
    source, rig = character()
    rig.scale = (scale,) * 3
    keys = source.data.shape_keys
    if remesh_in_frame is None:
        at_rest(rig)
        source.show_only_shape_key, source.active_shape_key_index = True, 0
    else:
        bpy.context.scene.frame_set(remesh_in_frame)
    bpy.context.view_layer.update()
    world.remesh(source, vertices=vertices, **settings)
    at_rest(rig, False)
    source.show_only_shape_key = False
    assert keys.key_blocks
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"}
    made = bpy.context.object
    assert bpy.context.selected_objects == [made] and made != source
    return source, rig, made


def apart(world, one, other):
    """The mean distance of two surfaces, as a fraction of the size; of the root mean square, which is no less."""
    return world.native().compare(*world.evaluated(one), *world.evaluated(other), 10000)["l2"]


def moves_alike(world, source, made):
    found = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        found.append(apart(world, made, source))
    print("apart by", " ".join(f"{one:.1e}" for one in found))
    assert max(found) <= MOST
    # And they do move: the poses differ by much more.
    first, _, _ = world.evaluated(made)
    bpy.context.scene.frame_set(FRAMES[0])
    last, _, _ = world.evaluated(made)
    assert numpy.linalg.norm(last - first, axis=1).mean() > 0.05


@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_an_animated_character(world, scale):
    source, rig, made = rigged(world, scale)
    assert made.name == "character_quads" and [modifier.object for modifier in made.modifiers] == [rig]
    moves_alike(world, source, made)


def test_remeshed_in_a_pose(world):
    """The mesh goes back to rest: else it would be moved twice."""
    source, _, made = rigged(world, remesh_in_frame=4)
    moves_alike(world, source, made)


def test_after_reopening_in_another_pose(world, tmp_path):
    source, rig = character()
    at_rest(rig)
    source.show_only_shape_key, source.active_shape_key_index = True, 0
    _, _, preview = world.remesh(source, vertices=6000)
    at_rest(rig, False)
    source.show_only_shape_key = False
    bpy.context.scene.frame_set(7)
    names = source.name, preview.name
    path = str(tmp_path / "character.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    module("features.levels.kept").forget()
    bpy.ops.wm.open_mainfile(filepath=path)
    source, preview = (bpy.data.objects[name] for name in names)
    world.select(preview)
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"}
    moves_alike(world, source, bpy.context.object)


def at_random(world, made, source, values):
    """Values, (n, k) by the vertices of either mesh, at random points of the one and the nearest points of the other: values(object) -> array."""
    one, other = Surface(made), Surface(source)
    chosen, weights = one.random(5000)
    points = numpy.einsum("vk,vki->vi", weights, one.points[one.triangles[chosen]])
    from mathutils.bvhtree import BVHTree

    tree = BVHTree.FromPolygons(other.points.tolist(), other.triangles.tolist(), all_triangles=True)
    found = [tree.find_nearest(point) for point in points.tolist()]
    nearest = numpy.array([hit[2] for hit in found])
    shares = module("bridge.arrays").closest_weights(numpy.array([hit[0] for hit in found]), other.points[other.triangles[nearest]])
    mine = numpy.einsum("vk,vk...->v...", weights, values(made)[one.triangles[chosen]])
    return mine, numpy.einsum("vk,vk...->v...", shares, values(source)[other.triangles[nearest]])


def test_weights_and_keys_at_random_points(world):
    source, rig, made = rigged(world)
    at_rest(rig)
    for obj in (source, made):
        obj.show_only_shape_key, obj.active_shape_key_index = True, 0
    bpy.context.view_layer.update()
    assert [group.name for group in made.vertex_groups] == [group.name for group in source.vertex_groups]

    def weights(obj):
        names = {group.index: number for number, group in enumerate(obj.vertex_groups)}
        found = numpy.zeros((len(obj.data.vertices), len(names)))
        for vertex in obj.data.vertices:
            for group in vertex.groups:
                found[vertex.index, names[group.group]] = group.weight
        return found

    mine, wanted = at_random(world, made, source, weights)
    errors = numpy.abs(mine - wanted).mean(axis=0)
    print("weights off by", errors.max())
    assert wanted.max() > 0.9 and errors.max() <= 0.01
    for number, key in enumerate(source.data.shape_keys.key_blocks[1:], 1):

        def moved(obj):
            blocks = obj.data.shape_keys.key_blocks
            points = [module("bridge.meshes").values_of(blocks[name].data, "co", 3).astype(float) for name in (key.name, blocks[0].name)]
            return points[0] - points[1]

        mine, wanted = at_random(world, made, source, moved)
        error, most = numpy.linalg.norm(mine - wanted, axis=1).mean(), numpy.linalg.norm(wanted, axis=1).max()
        print(f"{key.name} off by {error / most:.1e} of {most:.2f}")
        assert most > 0.1 and error <= 0.01 * most
        own = made.data.shape_keys.key_blocks[number]
        assert (own.name, own.slider_min, own.slider_max, own.vertex_group, own.relative_key.name) == (
            key.name, key.slider_min, key.slider_max, key.vertex_group, key.relative_key.name,
        )  # fmt: skip


def test_multires_and_bake(world):
    """The rig comes before Multires, so that sculpted details go with it; what was sculpted stays."""
    source, rig = character()
    at_rest(rig)
    source.show_only_shape_key, source.active_shape_key_index = True, 0
    _, _, preview = world.remesh(source, vertices=8000)
    at_rest(rig, False)
    source.show_only_shape_key = False
    world.select(preview)
    assert bpy.ops.hybrid_mesh.convert_to_multires() == {"FINISHED"}
    made = bpy.context.object
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"} and bpy.context.object == made
    assert [modifier.type for modifier in made.modifiers] == ["ARMATURE", "MULTIRES"]
    bpy.context.scene.frame_set(5)
    # Its mesh has the weights of the base alone, so that it bends less sharply than the source.
    found = apart(world, made, source)
    print(f"Multires apart by {found:.1e}")
    assert found < 2 * MOST
    # Once more: nothing is there twice.
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"}
    assert [modifier.type for modifier in made.modifiers] == ["ARMATURE", "MULTIRES"] and len(made.data.shape_keys.key_blocks) == 4


def test_modifiers_of_the_source_count(world):
    """Weights and keys are those of the evaluated mesh."""
    source, rig = character(resolution=0.1)
    modifier = source.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 1
    at_rest(rig)
    source.show_only_shape_key, source.active_shape_key_index = True, 0
    world.remesh(source, vertices=6000)
    at_rest(rig, False)
    source.show_only_shape_key = False
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"}
    moves_alike(world, source, bpy.context.object)


def longest_edge(mesh):
    return max((mesh.vertices[edge.vertices[0]].co - mesh.vertices[edge.vertices[1]].co).length for edge in mesh.edges)


def cut_edges(mesh):
    """The ends of the edges between faces on both sides of y = 0."""
    sides = {}
    for polygon in mesh.polygons:
        for key in polygon.edge_keys:
            sides.setdefault(key, set()).add(polygon.center.y > 0)
    return [[mesh.vertices[vertex].co for vertex in key] for key, found in sides.items() if len(found) == 2]


def test_seams_and_custom_properties(world):
    source, rig = character(animated=False, resolution=0.1)
    at_rest(rig)
    layer = source.data.uv_layers.new(name="map")
    uv = numpy.array([(source.data.vertices[loop.vertex_index].co.x, source.data.vertices[loop.vertex_index].co.z) for loop in source.data.loops])
    for polygon in source.data.polygons:
        if polygon.center.y > 0:
            uv[list(polygon.loop_indices)] += (5, 0)
    collection, name = module("compat").uv_values(layer)
    collection.foreach_set(name, uv.astype(numpy.float32).ravel())
    for edge in source.data.edges:
        edge.use_seam = True
    source["tag"], source["number"], source.data["text"] = "hero", 3, "body"
    source.id_properties_ui("number").update(min=1, max=5)
    world.remesh(source, vertices=4000)
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"}
    made = bpy.context.object
    assert (made["tag"], made["number"], made.data["text"]) == ("hero", 3, "body")
    assert made.id_properties_ui("number").as_dict()["max"] == 5
    seams = [edge for edge in made.data.edges if edge.use_seam]
    assert 20 < len(seams) < len(made.data.edges) / 5
    # They are where the source's map is cut, which has teeth, but for a quad and a face of the source's: a quad has the side of what lies under its middle.
    here = [made.data.vertices[vertex].co for edge in seams for vertex in edge.vertices]
    cut = [numpy.array(vertices) for vertices in cut_edges(source.data)]
    off = numpy.linalg.norm(numpy.array(here)[:, None] - numpy.array(cut).mean(1)[None], axis=2).min(1)
    assert off.max() < longest_edge(source.data) + longest_edge(made.data) and off.mean() < longest_edge(made.data) / 2



def test_undo(world):
    source, rig = character(animated=False, resolution=0.1)
    at_rest(rig)
    _, levels, preview = world.remesh(source, vertices=2000)
    world.select(preview)
    bpy.ops.ed.undo_push(message="before")
    before = counts()
    assert bpy.ops.hybrid_mesh.retarget("EXEC_DEFAULT", True) == {"FINISHED"}
    after, shape = counts(), world.evaluated(bpy.context.object)[0]
    bpy.ops.ed.undo()
    assert counts() == before
    bpy.ops.ed.redo()
    assert counts() == after and numpy.array_equal(world.evaluated(bpy.data.objects["character_quads"])[0], shape)


def test_the_source_stays_as_it_is(world):
    source, rig = character(resolution=0.1)
    bpy.context.scene.frame_set(3)
    before = counts(), places(source), world.evaluated(source)[0], [key.value for key in source.data.shape_keys.key_blocks]
    world.remesh(source, vertices=2000)
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"}
    assert numpy.array_equal(places(source), before[1]) and numpy.array_equal(world.evaluated(source)[0], before[2])
    assert [key.value for key in source.data.shape_keys.key_blocks] == before[3] and not source.show_only_shape_key
    new = set(counts()["objects"]) - set(before[0]["objects"])
    assert {name for name in new if not name.startswith("character.")} == {"character_quads"}


def test_what_cannot_be_done_is_said(world):
    plain = world.scan()
    _, _, preview = world.remesh(plain)
    before = counts()
    world.select(preview)
    refused(bpy.ops.hybrid_mesh.retarget, "scan has neither an armature nor shape keys")
    assert counts() == before
    source, rig = character(animated=False, resolution=0.1)
    at_rest(rig)
    collection, _, preview = world.remesh(source, vertices=2000)
    world.select(preview)
    assert bpy.ops.hybrid_mesh.make_mesh(level="FINAL") == {"FINISHED"}
    made = bpy.context.object
    # Elsewhere than the source.
    points = places(made)
    made.data.vertices.foreach_set("co", (points + (0, 0, 3)).ravel())
    refused(bpy.ops.hybrid_mesh.retarget, "does not lie on character")
    made.data.vertices.foreach_set("co", points.ravel())
    other = bpy.data.objects.new("other", made.data)
    refused(bpy.ops.hybrid_mesh.retarget, "shares its mesh")
    bpy.data.objects.remove(other)
    collection.hybrid_mesh.source = None
    refused(bpy.ops.hybrid_mesh.retarget, "is not known")
    assert made.data.shape_keys is None and not made.modifiers


def test_a_made_mesh_with_other_vertices_takes_the_nearest_places(world):
    source, rig = character(animated=False, resolution=0.1)
    at_rest(rig)
    _, _, preview = world.remesh(source, vertices=4000)
    activate(world, preview)
    assert bpy.ops.hybrid_mesh.make_mesh(level="FINAL") == {"FINISHED"}
    made = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.hybrid_mesh.retarget() == {"FINISHED"}
    at_rest(rig, False)
    for number, bone in enumerate(rig.pose.bones):
        bone.rotation_mode, bone.rotation_euler = "XYZ", (0.3 * numpy.sin(number), 0.2, 0.3)
    bpy.context.view_layer.update()
    assert apart(world, made, source) <= MOST
