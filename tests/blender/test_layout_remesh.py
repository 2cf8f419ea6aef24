# SPDX-License-Identifier: GPL-3.0-or-later
"""Remeshes from drawn layouts and of drawn regions."""

import json

import bpy
import numpy
import pytest

from conftest import module
from cube import cube_lines
from layout_tools import broken_cube, draw, layout_of, read, state, strokes, vector


def plan_of(obj):
    return module("features.levels.properties").plan_of(module("features.levels.properties").hierarchy_of(obj))


def address(obj, face):
    meshes = module("bridge.meshes")
    return module("core.plans").address(*(int(meshes.face_numbers(obj, name)[face]) for name in (meshes.ROOT, meshes.PATH)))


def refused(operator, words, **settings):
    before = {collection.name for collection in bpy.data.collections}
    with pytest.raises(RuntimeError, match=words):
        operator(**settings)
    assert {collection.name for collection in bpy.data.collections} == before


def from_layout(world, scan, vertices=2000):
    draw(scan, cube_lines(scan))
    bpy.context.scene.hybrid_mesh.vertices, bpy.context.scene.hybrid_mesh.hide_source = vertices, False
    assert bpy.ops.hybrid_mesh.remesh_layout() == {"FINISHED"}
    return world.hierarchy(scan)


@pytest.mark.parametrize("place", [{}, {"location": (5, -2, 1), "rotation_euler": (0.4, -1.2, 2.5), "scale": (0.3, 2, 1.1)}])
def test_the_base_is_what_was_drawn(world, place):
    scan = world.scan(**place)
    before = state(scan)
    _, levels, preview = from_layout(world, scan)
    assert state(scan) == before and bpy.context.object == preview and bpy.context.mode == "OBJECT"
    assert [len(level.data.polygons) for level in levels] == [6 * 4**number for number in range(len(levels))] and len(levels) >= 4
    assert all(level.matrix_world == scan.matrix_world for level in levels)
    assert world.distance(scan, levels[-1])["hausdorff"] < 0.03
    # Every corner of the base is one of the nodes that were drawn, though they have moved to where the map is even.
    corners = world.evaluated(levels[0])[0]
    nodes = numpy.array([line[end] for line in read(layout_of(scan)) for end in (0, -1)])
    nodes = numpy.array(sorted({tuple(numpy.round(node, 1)) for node in nodes}))
    assert len(nodes) == len(corners) == 8
    assert len(set(numpy.linalg.norm(corners[:, None] - nodes, axis=2).argmin(axis=1))) == 8


def test_a_layout_with_problems_is_not_remeshed(world):
    scan = world.scan()
    layout = draw(scan, broken_cube(scan))
    refused(bpy.ops.hybrid_mesh.remesh_layout, "marked in red")
    assert len(layout.hybrid_mesh_layout.problems) and layout_of(scan, "PROBLEMS") is not None
    # Put right, it is, and the marks go.
    strokes().remove_layers(layout)
    strokes().write(layout, strokes().add_layer(layout, "again", 1), 1, cube_lines(scan))
    assert bpy.ops.hybrid_mesh.remesh_layout() == {"FINISHED"}
    assert not len(layout.hybrid_mesh_layout.problems) and layout_of(scan, "PROBLEMS") is None


def test_a_remesh_from_a_layout_is_one_undo_step(world):
    draw(world.scan(), cube_lines(bpy.data.objects["scan"]))
    bpy.context.scene.hybrid_mesh.vertices = 500
    bpy.ops.ed.undo_push(message="before")
    names = {obj.name for obj in bpy.data.objects}
    assert bpy.ops.hybrid_mesh.remesh_layout("EXEC_DEFAULT", True) == {"FINISHED"}
    assert {obj.name for obj in bpy.data.objects} > names
    bpy.ops.ed.undo()
    assert {obj.name for obj in bpy.data.objects} == names and "scan hierarchy" not in bpy.data.collections


def test_every_hierarchy_keeps_its_plan(world, tmp_path):
    scan = world.scan()
    world.remesh(scan, vertices=500)
    text = plan_of(scan)
    plan = json.loads(text)
    assert plan["format"] == "hybrid-mesh plan" and plan["version"] == 1 and len(plan["base"]["quads"]) > 0 and "operations" not in plan
    path = str(tmp_path / "plan.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    assert plan_of(bpy.data.objects["scan"]) == text


def test_level_faces_have_addresses(world):
    _, levels, _ = world.remesh(world.scan(), vertices=500)
    for number, level in enumerate(levels):
        found = [address(level, face) for face in range(len(level.data.polygons))]
        assert len(set(found)) == len(found) and {one.count(".") for one in found} == {number}
    # Children lie where their parents do.
    parents = {address(levels[0], face): levels[0].data.polygons[face].center for face in range(len(levels[0].data.polygons))}
    gaps = [(polygon.center - parents[address(levels[1], polygon.index).split(".")[0]]).length for polygon in levels[1].data.polygons]
    assert max(gaps) < 0.6 * levels[0].dimensions.length


class Region:
    """Two neighbouring quads of N1 over which another side between them is drawn."""

    def __init__(self, world, scan):
        _, self.levels, self.preview = from_layout(world, scan)
        self.scan, self.level = scan, self.levels[1]
        mesh = self.level.data
        self.faces = self._pair(mesh)
        world.select(self.level)
        for polygon in mesh.polygons:
            polygon.select = polygon.index in self.faces
        self.addresses = sorted((address(self.level, face) for face in self.faces), key=lambda text: [int(one) for one in text.split(".")])

    def _pair(self, mesh):
        edge = mesh.polygons[0].edge_keys[0]
        return {0, next(polygon.index for polygon in mesh.polygons if polygon.index and edge in polygon.edge_keys)}

    def line(self):
        """From a corner of the region's six to the one opposite, through the middle: two new quads."""
        mesh, place = self.level.data, self.level.matrix_world
        first, second = (mesh.polygons[face] for face in sorted(self.faces))
        shared = next(key for key in first.edge_keys if key in second.edge_keys)

        def beside(polygon, corner):
            return next(({*key} - {corner}).pop() for key in polygon.edge_keys if corner in key and key != shared)

        one, other = mesh.vertices[beside(first, shared[0])].co, mesh.vertices[beside(second, shared[1])].co
        middle = (mesh.vertices[shared[0]].co + mesh.vertices[shared[1]].co) / 2
        return numpy.array([place @ point for point in (one, (one + middle) / 2, middle, (middle + other) / 2, other)])

    def draw(self, lines):
        # Draw Layout keeps the selection of faces.
        return draw(self.level, lines)


@pytest.fixture
def region(world):
    return Region(world, world.scan(rotation_euler=(0.3, 0.2, 0.1), scale=(1, 1.5, 0.8)))


def test_a_region_becomes_an_operation(world, region):
    region.draw([region.line()])
    before = state(region.scan)
    collections, texts = len(bpy.data.collections), len(bpy.data.texts)
    names, groups = [obj.name for obj in region.levels], len(bpy.data.node_groups)
    faces = len(region.level.data.polygons)
    assert bpy.ops.hybrid_mesh.repatch_region(buffer_rings=2) == {"FINISHED"}
    assert state(region.scan) == before
    # In place: the same collection and objects.
    preview = bpy.context.object
    assert preview == region.preview and bpy.context.mode == "OBJECT"
    assert (len(bpy.data.collections), len(bpy.data.texts), len(bpy.data.node_groups)) == (collections, texts, groups)
    kept_levels = [bpy.data.objects[name] for name in names]
    assert all(obj.hybrid_mesh.hierarchy == preview.hybrid_mesh.hierarchy and obj.data.name == obj.name for obj in kept_levels)
    assert len(level_of(preview, "M1").data.polygons) == faces and module("bridge.levels").shown_object(preview) == region.levels[-1]
    rows = module("features.levels.panel").level_rows(preview.hybrid_mesh.hierarchy)
    assert [row[0] for row in rows][:3] == ["N0", "M1", "N1"]
    plan = json.loads(plan_of(preview))
    assert [(one["level"], one["quads"], one["buffer_rings"]) for one in plan["operations"]] == [(1, region.addresses, 2)]
    made = [obj for obj in preview.hybrid_mesh.hierarchy.objects if obj.hybrid_mesh.role == "LEVEL"]
    final = max(made, key=lambda obj: len(obj.data.polygons))
    assert module("bridge.meshes").get_attribute(final.data, "irregular").any()
    assert world.distance(region.scan, final)["hausdorff"] < 0.03
    assert not any(obj.visible_get() for obj in made)


def test_a_region_is_one_undo_step(world, region):
    region.level.hide_set(False)
    select_faces(world, region.level, region.faces)
    hierarchy = region.level.hybrid_mesh.hierarchy
    bpy.ops.ed.undo_push(message="before")
    before = {obj.name: len(obj.data.vertices) for obj in hierarchy.objects}, plan_of(region.scan), hierarchy.hybrid_mesh.token, len(bpy.data.meshes)
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    scan = bpy.data.objects["scan"]
    hierarchy, levels, preview = world.hierarchy(scan)
    assert before == ({obj.name: len(obj.data.vertices) for obj in hierarchy.objects}, plan_of(scan), hierarchy.hybrid_mesh.token, len(bpy.data.meshes))
    assert module("features.levels.kept").find(hierarchy).hierarchy.operation_count == 0
    assert module("bridge.levels").shown_object(preview) == levels[-1]


def test_a_region_is_taken_in_edit_mode(world, region):
    region.draw([region.line()])
    bpy.ops.object.mode_set(mode="OBJECT")
    world.select(region.level)
    bpy.context.scene.tool_settings.mesh_select_mode = (False, False, True)
    bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.hybrid_mesh.repatch_region() == {"FINISHED"}
    assert json.loads(plan_of(bpy.context.object))["operations"][0]["quads"] == region.addresses


def test_problems_of_a_region_are_marked(world, region):
    layout = region.draw([region.line()[:3]])  # ends in the middle of nowhere
    refused(bpy.ops.hybrid_mesh.repatch_region, "curve|face")
    assert len(layout.hybrid_mesh_layout.problems) and layout_of(region.level, "PROBLEMS") is not None


def test_quads_that_were_replaced_are_no_region(world, region):
    region.level.hide_set(False)
    select_faces(world, region.level, region.faces)
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    before = level_of(bpy.context.object, "M1")  # the level without the operation
    before.hide_set(False)
    found = [address(before, face) for face in range(len(before.data.polygons))]
    replaced = {found.index(one) for one in region.addresses}
    select_faces(world, before, {*replaced, next(face for face in range(len(found)) if face not in replaced)})
    refused(bpy.ops.hybrid_mesh.repatch_region, "2 of the selected faces of scan.M1 .* select faces of scan.N1", layout_kind="AUTOMATIC")


@pytest.mark.parametrize("vertices, fewer", [(1600, True), (2000, False)])
def test_a_region_that_costs_a_level_says_so(world, capfd, vertices, fewer):
    _, levels, _ = from_layout(world, world.scan(), vertices)
    levels[1].hide_set(False)
    select_faces(world, levels[1], {0})
    module("features.levels.kept").forget()  # as in a file that was opened: the source is remeshed
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    made = [obj for obj in bpy.context.object.hybrid_mesh.hierarchy.objects if obj.hybrid_mesh.level.startswith("N")]
    assert len(made) == len(levels) - fewer
    assert ("the bound of 1,600 vertices leaves one level less" in capfd.readouterr().out) == fewer


@pytest.mark.parametrize("vertices, more", [(1600, True), (2000, False)])
def test_a_region_of_the_hierarchy_at_hand_keeps_all_that_is_farther_off(world, capfd, vertices, more):
    _, levels, _ = from_layout(world, world.scan(), vertices)
    levels[1].hide_set(False)
    select_faces(world, levels[1], {0})
    before = [[tuple(vertex.co) for vertex in level.data.vertices] for level in levels]
    token = levels[0].hybrid_mesh.hierarchy.hybrid_mesh.token
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    made = [level_of(bpy.context.object, level.hybrid_mesh.level) for level in levels]
    assert ("more than the bound of 1,600" in capfd.readouterr().out) == more
    for old, new in zip(before, made, strict=True):
        points = {tuple(vertex.co) for vertex in new.data.vertices}
        kept = sum(place in points for place in old) / len(old)
        assert kept == 1 if new.hybrid_mesh.level == "N0" else kept > 0.3
    report = module("features.levels.properties").report_of(bpy.context.object.hybrid_mesh.hierarchy)
    assert report["final"]["vertices"] == len(made[-1].data.vertices) and report["final"]["l2"] is None
    # One more, in the hierarchy that has come of it; then what undo brings back is at hand as it was.
    first = bpy.context.object.hybrid_mesh.hierarchy.hybrid_mesh.token
    finer = made[2]
    finer.hide_set(False)
    irregular = module("bridge.meshes").get_attribute(finer.data, "irregular")
    select_faces(world, finer, {next(face for face, new in enumerate(irregular) if not new)})
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    assert len(operations(bpy.context.object)) == 2
    kept = module("features.levels.kept")
    assert kept.of_token(first).hierarchy.operation_count == 1 and kept.of_token(token).hierarchy.operation_count == 0


def test_strokes_of_a_region_that_are_no_curves_are_named(world, region):
    bad = region.line()
    bad[1] = numpy.nan
    region.draw([region.line(), bad])
    refused(bpy.ops.hybrid_mesh.repatch_region, "scan.N1.layout: .*not finite .stroke 2 of Layout.")


def test_what_is_no_region(world, region):
    region.draw([region.line()])
    hierarchy, mesh = region.level.hybrid_mesh.hierarchy, region.level.data
    for face in region.faces:
        mesh.polygons[face].select = False
    refused(bpy.ops.hybrid_mesh.repatch_region, "no faces are selected")
    mesh.polygons[0].select = True
    plan = plan_of(region.scan)
    module("features.levels.kept").forget()  # else nothing is read of the plan
    hierarchy.hybrid_mesh.plan.clear()
    hierarchy.hybrid_mesh.plan.write("{}")
    refused(bpy.ops.hybrid_mesh.repatch_region, "plan")
    hierarchy.hybrid_mesh.plan.clear()
    hierarchy.hybrid_mesh.plan.write(plan)
    path = mesh.attributes["path"].data[0].value
    mesh.attributes["path"].data[0].value = 1
    refused(bpy.ops.hybrid_mesh.repatch_region, "another level")
    mesh.attributes["path"].data[0].value = 0
    refused(bpy.ops.hybrid_mesh.repatch_region, "not made by a remesh")
    mesh.attributes["path"].data[0].value = path
    hierarchy.hybrid_mesh.source = None
    refused(bpy.ops.hybrid_mesh.repatch_region, "gone")
    world.select(region.scan)
    assert not bpy.ops.hybrid_mesh.repatch_region.poll()


def operations(obj):
    return module("features.levels.properties").operations_of(obj.hybrid_mesh.hierarchy)


def level_of(preview, name):
    return next(obj for obj in preview.hybrid_mesh.hierarchy.objects if obj.hybrid_mesh.role == "LEVEL" and obj.hybrid_mesh.level == name)


def select_faces(world, level, faces):
    world.select(level)
    for polygon in level.data.polygons:
        polygon.select = polygon.index in faces


@pytest.mark.parametrize("kind, new_quads", [("DRAWN", None), ("AUTOMATIC", None), ("CUBES", 14)])
def test_a_region_is_laid_out_without_curves(world, region, kind, new_quads):
    region.level.hide_set(False)
    select_faces(world, region.level, region.faces)
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind=kind, height=2, buffer_rings=0) == {"FINISHED"}
    preview = bpy.context.object
    (operation,) = json.loads(plan_of(preview))["operations"]
    assert operation["layout"] == ("automatic" if kind == "DRAWN" else kind.lower()) and operation["quads"] == region.addresses and "curves" not in operation
    (made,) = operations(preview)
    assert sorted(made["quads"]) == sorted(region.addresses) and made["corners"] == 6
    assert new_quads is None or len(made["new_quads"]) == new_quads
    assert world.distance(region.scan, level_of(preview, sorted(one.hybrid_mesh.level for one in preview.hybrid_mesh.hierarchy.objects)[-1]))["hausdorff"] < 0.03


def around(world, region):
    """The faces that share a vertex with the region's, but for the region: a ring."""
    mesh = region.level.data
    inside = {v for f in region.faces for v in mesh.polygons[f].vertices}
    return [p.index for p in mesh.polygons if p.index not in region.faces and inside & set(p.vertices)]


@pytest.mark.parametrize("kind", ["ROWS", "EVEN", "AUTOMATIC"])
def test_a_ring_of_quads_is_laid_out_anew(world, region, kind):
    region.level.hide_set(False)
    ring = around(world, region)
    select_faces(world, region.level, ring)
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind=kind, buffer_rings=1) == {"FINISHED"}
    preview = bpy.context.object
    (operation,) = json.loads(plan_of(preview))["operations"]
    assert operation["layout"] == kind.lower() and len(operation["quads"]) == len(ring)
    (made,) = operations(preview)
    assert made["kind"] == "repatch" and len(made["quads"]) == len(ring)


def test_a_disk_has_no_rows(world, region):
    region.level.hide_set(False)
    select_faces(world, region.level, region.faces)
    with pytest.raises(RuntimeError, match="ring"):
        bpy.ops.hybrid_mesh.repatch_region(layout_kind="ROWS")


def test_a_region_of_a_semi_regular_remesh_becomes_an_operation(world):
    bpy.context.scene.hybrid_mesh.semi_regular = True
    region = Region(world, world.scan())
    region.level.hide_set(False)
    select_faces(world, region.level, region.faces)
    faces = len(region.level.data.polygons)
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    assert len(operations(bpy.context.object)) == 1 and len(level_of(bpy.context.object, "N1").data.polygons) == faces + 6


@pytest.mark.parametrize("place", [{}, {"scale": (-1, 1, 1.3)}])
def test_a_layout_is_copied_to_another_region(world, place):
    region = Region(world, world.scan(**place))
    region.level.hide_set(False)
    select_faces(world, region.level, region.faces)
    refused(bpy.ops.hybrid_mesh.repatch_region, "no operation whose layout can be copied", layout_kind="COPY")
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="CUBES", height=1) == {"FINISHED"}
    first = bpy.context.object
    level = level_of(first, "N1")
    level.hide_set(False)
    # Two neighbours that are far from what is new.
    mesh = level.data
    new = module("bridge.meshes").get_attribute(mesh, "irregular")
    middle = numpy.mean([polygon.center for polygon in mesh.polygons if new[polygon.index]], axis=0)
    far = max((polygon.index for polygon in mesh.polygons if not new[polygon.index]), key=lambda face: (mesh.polygons[face].center - vector(middle)).length)
    edge = mesh.polygons[far].edge_keys[0]
    pair = {far, next(polygon.index for polygon in mesh.polygons if polygon.index != far and edge in polygon.edge_keys)}
    select_faces(world, level, {far})
    refused(bpy.ops.hybrid_mesh.repatch_region, "has 4 sides.*6", layout_kind="COPY", source="0")
    select_faces(world, level, pair)
    hierarchy = level.hybrid_mesh.hierarchy.hybrid_mesh
    # An operation whose quads are no disk cannot be copied; the first one that can be is what is copied where nothing is said.
    hierarchy.operations = json.dumps([{**json.loads(hierarchy.operations)[0], "corners": 0}, *json.loads(hierarchy.operations)])
    assert bpy.ops.hybrid_mesh.repatch_region(layout_kind="COPY") == {"FINISHED"}
    made = operations(bpy.context.object)
    assert len(made) == 2 and made[0]["new_quads"] == made[1]["new_quads"] and made[0]["quads"] != made[1]["quads"]
    # The removed quads lie in their layout in the same way.
    counts = [module("features.layouts.region_quads").removed_counts(bpy.context.object.hybrid_mesh.hierarchy, one) for one in made]
    assert counts[0] == counts[1] and sorted(counts[0]) == [1, 1, 1, 1, 2, 2]
