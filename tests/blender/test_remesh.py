# SPDX-License-Identifier: GPL-3.0-or-later
import math
import time

import bmesh
import bpy
import numpy
import pytest

from conftest import module


def state(obj):
    """Everything of an object that an operator could have changed."""
    mesh = obj.data
    points = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", points)
    return (
        obj.name, mesh.name, points.tobytes(), tuple(map(tuple, obj.matrix_world)), obj.parent, [one.name for one in obj.modifiers],
        [one.name for one in obj.users_collection], [slot.material for slot in obj.material_slots], obj.hide_get(), obj.hide_viewport,
        obj.hide_render, sorted(obj.keys()), len(mesh.attributes), len(mesh.uv_layers),
    )  # fmt: skip


def test_the_levels_are_quads_that_lie_on_the_source(world):
    source = world.scan()
    before = state(source)
    collection, levels, preview = world.remesh(source, vertices=3000)
    assert state(source) == before
    assert collection.name == "scan hierarchy" and preview.name == "scan.preview"
    assert [level.name for level in levels] == [f"scan.N{number}" for number in range(len(levels))]
    for coarse, fine in zip(levels[:-1], levels[1:]):
        assert len(fine.data.polygons) == 4 * len(coarse.data.polygons)
    final = levels[-1]
    assert all(len(polygon.vertices) == 4 for polygon in final.data.polygons)
    assert 0.98 * 3000 <= len(final.data.vertices) <= 3000
    assert world.distance(source, final)["hausdorff"] < 0.02
    assert bpy.context.object == preview and preview.select_get() and not source.select_get()
    summary = world.native().topology(*world.evaluated(final))
    assert summary["nonmanifold_edges"] == summary["nonmanifold_vertices"] == summary["misoriented_edges"] == summary["boundary_loops"] == 0
    assert summary["euler"] == 2


def test_levels_carry_their_figures(world):
    _, levels, _ = world.remesh(world.scan())
    patches = set()
    for level in levels:
        mesh = level.data
        assert mesh.attributes["stretch"].domain == "FACE" and mesh.attributes["stretch"].data_type == "FLOAT"
        assert mesh.attributes["irregular"].domain == "FACE" and mesh.attributes["irregular"].data_type == "BOOLEAN"
        assert mesh.attributes["patch"].data_type == "INT"
        assert mesh.color_attributes.active_color.name == "stretch_color"
        assert "patches" in mesh.uv_layers
        stretch = module("bridge.meshes").get_attribute(mesh, "stretch")
        assert (stretch > 0).all() and numpy.isfinite(stretch).all()
        patches.add(len(set(module("bridge.meshes").get_attribute(mesh, "patch").tolist())))
        layer = mesh.uv_layers["patches"].data
        values = numpy.empty(2 * len(layer), dtype=numpy.float32)
        layer.foreach_get("uv", values)
        assert values.min() >= 0 and values.max() <= 1
        assert level.modifiers["Subdivision Preview"].type == "SUBSURF" and not level.modifiers["Subdivision Preview"].show_viewport
    assert patches == {len(levels[0].data.polygons)}


def test_the_report_is_kept_and_read(world):
    collection, levels, _ = world.remesh(world.scan(), seed=3)
    properties = module("features.levels.properties")
    report = properties.report_of(collection)
    assert report["settings"]["seed"] == 3 and report["version"] and len(report["levels"]) == len(levels)
    quality = properties.quality_of(collection)
    assert quality["vertices"] == len(levels[-1].data.vertices)
    assert 0 < quality["l2"] <= quality["hausdorff"] < 0.02 and 0 <= quality["scaled_jacobian_p05"] <= quality["scaled_jacobian_p50"] <= 1
    labels = dict(module("features.levels.panel").quality_lines(quality))
    assert {"Vertices", "L2", "Hausdorff", "Irregular vertices", "Scaled Jacobian, median"} <= set(labels)


@pytest.mark.parametrize("scale", [(1, 1, 1), (0.2, 3, 1), (-1, 1, 1), (-2, -0.5, -1), (1e-3, 1e-3, 1e-3), (2000, 2000, 2000)])
def test_transforms(world, scale):
    source = world.scan(location=(50, -20, 3), rotation_euler=(0.3, 1.1, -2), scale=scale)
    _, levels, preview = world.remesh(source)
    final = levels[-1]
    for obj in (*levels, preview):
        assert obj.matrix_world == source.matrix_world
    assert world.distance(source, final)["hausdorff"] < 0.02
    # Outside is outside, in the world as in the object's own space.
    assert numpy.sign(world.volume(world.evaluated(final))) == numpy.sign(world.volume(world.evaluated(source)))
    assert world.volume(world.evaluated(final)) == pytest.approx(world.volume(world.evaluated(source)), rel=0.02)


def test_what_counts_is_the_shape_in_the_world(world):
    # A source stretched by its object's scale is remeshed like the same shape with the scale applied.
    source = world.scan("stretched", scale=(1, 1, 4))
    applied = world.scan("applied", scale=(1, 1, 4))
    bpy.ops.object.transform_apply(scale=True)
    one, two = world.remesh(source)[1][-1], world.remesh(applied)[1][-1]
    assert len(one.data.vertices) == len(two.data.vertices)
    assert world.distance(one, two)["hausdorff"] < 1e-5


def test_a_parent_is_kept(world):
    parent = bpy.data.objects.new("parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.location, parent.scale = (1, 2, 3), (2, 1, 1)
    source = world.scan(rotation_euler=(0, 0, 0.5))
    source.parent = parent
    source.matrix_parent_inverse.identity()
    bpy.context.view_layer.update()
    _, levels, preview = world.remesh(source)
    for obj in (levels[-1], preview):
        assert obj.parent == parent and obj.matrix_world == source.matrix_world
    assert world.distance(source, levels[-1])["hausdorff"] < 0.02


def test_modifiers_count(world):
    source = world.box()
    bevel = source.modifiers.new("Subdivision", "SUBSURF")
    bevel.levels = 4
    _, levels, _ = world.remesh(source)
    points, _, _ = world.evaluated(levels[-1])
    assert numpy.linalg.norm(points, axis=1).max() < 1.2  # the subdivided cube, not the cube whose corners are at 1.73
    assert world.distance(source, levels[-1])["hausdorff"] < 0.02


def test_n_gons(world):
    mesh = bpy.data.meshes.new("prism")
    graph = bmesh.new()
    # A star, so that a fan from a corner would leave the face.
    outline = [(math.cos(a) * r, math.sin(a) * r) for a, r in ((math.pi * k / 6, 1 if k % 2 else 0.4) for k in range(12))]
    bottom = [graph.verts.new((x, y, 0)) for x, y in outline]
    top = [graph.verts.new((x, y, 1)) for x, y in outline]
    graph.faces.new(bottom[::-1])
    graph.faces.new(top)
    for i in range(12):
        graph.faces.new((bottom[i], bottom[(i + 1) % 12], top[(i + 1) % 12], top[i]))
    graph.to_mesh(mesh)
    graph.free()
    source = bpy.data.objects.new("prism", mesh)
    bpy.context.scene.collection.objects.link(source)
    _, levels, _ = world.remesh(source, vertices=4000)
    summary = world.native().topology(*world.evaluated(levels[-1]))
    assert summary["boundary_loops"] == 0 and summary["euler"] == 2
    assert world.volume(world.evaluated(levels[-1])) == pytest.approx(world.volume(world.evaluated(source)), rel=0.03)


@pytest.mark.parametrize("name", ["Größe 猫", "a.b.c", "x" * 63, "猫" * 21, "with/slash"])
def test_names(world, name):
    source = world.scan(name)
    _, levels, preview = world.remesh(source, vertices=500)
    assert preview.name.endswith(".preview") and levels[-1].name.endswith(f".N{len(levels) - 1}")
    assert preview.name.startswith(source.name[:12])
    assert source.name == name


def test_again_makes_another_hierarchy(world):
    source = world.scan()
    first, _, _ = world.remesh(source, vertices=500)
    second, levels, _ = world.remesh(source, vertices=1000)
    assert first != second and len(levels[-1].data.vertices) > 500
    assert len(first.objects) > 2


def test_one_undo_step(world):
    world.scan()  # no name for it: undo makes references stale, and showing one in a failure would crash
    bpy.ops.ed.undo_push(message="before")
    names = {obj.name for obj in bpy.data.objects}
    assert bpy.ops.hybrid_mesh.remesh("EXEC_DEFAULT", True, vertices=500) == {"FINISHED"}
    made = {obj.name for obj in bpy.data.objects}
    assert made > names
    bpy.ops.ed.undo()
    assert {obj.name for obj in bpy.data.objects} == names and "scan hierarchy" not in bpy.data.collections
    bpy.ops.ed.redo()
    assert {obj.name for obj in bpy.data.objects} == made
    assert "scan" in bpy.data.objects


def test_invoke_in_the_background_does_the_work(world):
    world.scan()
    assert bpy.ops.hybrid_mesh.remesh("INVOKE_DEFAULT", vertices=500) == {"FINISHED"}
    assert "scan hierarchy" in bpy.data.collections


def test_several_objects(world):
    one, two = world.scan("one"), world.scan("two", location=(5, 0, 0))
    world.select(one, two)
    assert bpy.ops.hybrid_mesh.remesh(vertices=500) == {"FINISHED"}
    assert {"one hierarchy", "two hierarchy"} <= set(bpy.data.collections.keys())


def empty_mesh(world):
    obj = bpy.data.objects.new("empty", bpy.data.meshes.new("empty"))
    bpy.context.scene.collection.objects.link(obj)
    world.select(obj)
    return {}


def flat_scale(world):
    world.scan("flat", scale=(1, 0, 1))
    return {}


def too_few_vertices(world):
    world.scan("tight")
    return {"vertices": 3}


def needs_repair(world):
    source = world.scan("doubled")
    copy = source.data.copy()
    graph = bmesh.new()
    graph.from_mesh(source.data)
    graph.from_mesh(copy)  # every face twice
    graph.to_mesh(source.data)
    graph.free()
    return {"strict": True}


def no_area(world):
    mesh = bpy.data.meshes.new("needle")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [], [(0, 1, 2)])
    obj = bpy.data.objects.new("needle", mesh)
    bpy.context.scene.collection.objects.link(obj)
    world.select(obj)
    return {}


def not_finite(world):
    source = world.scan("infinite")
    # All at once: one by one Blender clamps what is not finite.
    points = numpy.empty(3 * len(source.data.vertices), dtype=numpy.float32)
    source.data.vertices.foreach_get("co", points)
    points[7] = numpy.nan
    source.data.vertices.foreach_set("co", points)
    source.data.update()
    return {}


@pytest.mark.parametrize("make", [empty_mesh, flat_scale, too_few_vertices, needs_repair, no_area, not_finite])
def test_what_cannot_be_done_is_said_and_nothing_is_made(world, make):
    settings = make(world)
    name = bpy.context.object.name
    before = set(bpy.data.objects), set(bpy.data.meshes), set(bpy.data.collections), set(bpy.data.node_groups)
    with pytest.raises(RuntimeError) as raised:
        bpy.ops.hybrid_mesh.remesh(**settings)
    assert name in str(raised.value) and "Traceback" not in str(raised.value)
    assert (set(bpy.data.objects), set(bpy.data.meshes), set(bpy.data.collections), set(bpy.data.node_groups)) == before


def test_the_good_ones_are_done_and_the_bad_one_is_named(world):
    good, bad = world.scan("good"), world.box("bad", scale=(0, 1, 1))
    world.select(good, bad)
    with pytest.raises(RuntimeError, match="bad"):
        bpy.ops.hybrid_mesh.remesh(vertices=500)
    assert "good hierarchy" in bpy.data.collections and "bad hierarchy" not in bpy.data.collections


def test_settings_out_of_bounds_cannot_be_given(world):
    world.scan()
    with pytest.raises((TypeError, RuntimeError)):
        bpy.ops.hybrid_mesh.remesh(refinement="BOTH")


def test_levels_and_base_are_as_given(world):
    _, levels, _ = world.remesh(world.scan(), vertices=0, levels=2, base="GIVEN", base_quads=100)
    assert len(levels) == 3 and [len(level.data.polygons) for level in levels[:2]] == [100, 400]


def test_nothing_selected_or_no_mesh_or_edit_mode(world):
    assert not bpy.ops.hybrid_mesh.remesh.poll()
    bpy.ops.object.camera_add()
    assert not bpy.ops.hybrid_mesh.remesh.poll()
    world.scan()
    assert bpy.ops.hybrid_mesh.remesh.poll()
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.hybrid_mesh.remesh.poll()
    bpy.ops.object.mode_set(mode="OBJECT")


def test_hide_source(world):
    source = world.scan()
    assert bpy.ops.hybrid_mesh.remesh(vertices=500, hide_source=True) == {"FINISHED"}
    preview = bpy.context.object
    assert source.hide_get() and source.hide_render and preview.visible_get() and not preview.hide_render


def test_previews_levels_and_layouts_stand_for_their_source(world, capfd):
    source = world.scan(subdivisions=3)
    modifier = source.modifiers.new("subdivision", "SUBSURF")
    group = source.vertex_groups.new(name="none")
    group = source.vertex_groups.new(name="upper")
    group.add([vertex.index for vertex in source.data.vertices if vertex.co.z > 0], 1, "REPLACE")
    _, levels, preview = world.remesh(source, vertices=400, effort="QUICK", hide_source=True)
    # Modifiers above the preview's own find the source's groups.
    assert [one.name for one in preview.vertex_groups] == ["none", "upper"]
    points, _, _ = world.evaluated(preview)
    push = preview.modifiers.new("push", "DISPLACE")
    push.vertex_group, push.strength = "upper", 10
    moved = numpy.linalg.norm(world.evaluated(preview)[0] - points, axis=1)
    assert moved[points[:, 2] > 0.4].min() > 1 and moved[points[:, 2] < -0.4].max() < 1e-6
    modifier.levels = 0  # of the source as it is now
    levels[1].hide_set(False)
    world.select(levels[1], preview)
    capfd.readouterr()
    assert bpy.ops.hybrid_mesh.remesh(vertices=400, effort="QUICK") == {"FINISHED"}
    made = bpy.context.object.hybrid_mesh.hierarchy
    assert made.hybrid_mesh.source == source and len(bpy.data.collections) == 2
    assert module("features.levels.properties").report_of(made)["input"]["vertices"] == len(source.data.vertices)
    assert "scan.N1, scan.preview: scan, the source, is remeshed" in capfd.readouterr().out
    source.hide_set(False)
    world.select(source)
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
    layout = bpy.context.object
    bpy.ops.object.mode_set(mode="OBJECT")
    world.select(layout)
    assert bpy.ops.hybrid_mesh.remesh(vertices=400, effort="QUICK") == {"FINISHED"}
    assert bpy.context.object.hybrid_mesh.hierarchy.hybrid_mesh.source == source
    # Its source gone, a level is what it is: a mesh.
    bpy.data.objects.remove(source)
    world.select(levels[1])
    assert bpy.ops.hybrid_mesh.remesh(vertices=400, effort="QUICK") == {"FINISHED"}
    assert bpy.context.object.hybrid_mesh.hierarchy.hybrid_mesh.source == levels[1]


def test_materials_come_along(world):
    source = world.scan()
    for name in ("left", "right"):
        source.data.materials.append(bpy.data.materials.new(name))
    for polygon in source.data.polygons:
        polygon.material_index = int(polygon.center.x > 0)
    _, levels, _ = world.remesh(source)
    final = levels[-1].data
    assert [material.name for material in final.materials] == ["left", "right"]
    sides = [(polygon.center.x > 0, polygon.material_index == 1) for polygon in final.polygons if abs(polygon.center.x) > 0.15]
    assert sum(a == b for a, b in sides) == len(sides)


def test_what_the_surface_carries_comes_along(world):
    for scale in ((1, 1, 1), (1, -2, 1)):
        source = world.scan(scale=scale)
        mesh = source.data
        group = source.vertex_groups.new(name="height")
        for vertex in mesh.vertices:
            group.add([vertex.index], min(1, max(0, 0.5 + 0.3 * vertex.co.z)), "REPLACE")
        color = mesh.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
        for vertex in mesh.vertices:
            color.data[vertex.index].color = (0.5 + 0.3 * vertex.co.x, 0, 0, 1)
        side = mesh.attributes.new("side", "INT", "FACE")
        for polygon in mesh.polygons:
            side.data[polygon.index].value = 7 if polygon.center.z > 0 else -7
        # A UV map with a seam at x = 0.
        for layer in list(mesh.uv_layers):
            mesh.uv_layers.remove(layer)
        layer = mesh.uv_layers.new(name="unwrapped")
        for polygon in mesh.polygons:
            for corner in polygon.loop_indices:
                place = mesh.vertices[mesh.loops[corner].vertex_index].co
                layer.data[corner].uv = (place.y, place.z + (10 if polygon.center.x > 0 else 0))

        _, levels, _ = world.remesh(source, vertices=3000, effort="QUICK")
        final, made = levels[-1], levels[-1].data
        paint = made.attributes["paint"].data
        # In object space, where the source's values were made; the fit moves vertices a little.
        for vertex in made.vertices:
            assert abs(paint[vertex.index].color[0] - (0.5 + 0.3 * vertex.co.x)) < 0.01
            weight = next((element.weight for element in vertex.groups), 0)
            assert abs(weight - min(1, max(0, 0.5 + 0.3 * vertex.co.z))) < 0.01
        assert final.vertex_groups[0].name == "height" and made.color_attributes.active_color.name == "stretch_color"
        assert made.uv_layers.active.name == "unwrapped" and made.uv_layers["unwrapped"].active_render
        uv = made.uv_layers["unwrapped"].data
        torn = 0
        for polygon in made.polygons:
            places = [made.vertices[vertex].co for vertex in polygon.vertices]
            values = [uv[corner].uv for corner in polygon.loop_indices]
            assert max(abs(value[0] - place.y) for value, place in zip(values, places)) < 0.1
            torn += max(value[1] for value in values) - min(value[1] for value in values) > 5
            if abs(polygon.center.z) > 0.1:
                assert made.attributes["side"].data[polygon.index].value == (7 if polygon.center.z > 0 else -7)
        assert torn == 0


def test_adaptive(world):
    source = world.scan()
    collection, levels, _ = world.remesh(source, refinement="ADAPTIVE", vertices=3000)
    assert all(len(polygon.vertices) == 4 for polygon in levels[-1].data.polygons)
    assert 0.98 * 3000 <= len(levels[-1].data.vertices) <= 3000
    assert world.distance(source, levels[-1])["hausdorff"] < 0.02


def test_presets_set_the_scene(world):
    assert bpy.ops.hybrid_mesh.preset(name="GAME") == {"FINISHED"}
    assert bpy.context.scene.hybrid_mesh.refinement == "ADAPTIVE"
    assert bpy.ops.hybrid_mesh.preset(name="DRAFT") == {"FINISHED"}
    settings = module("features.remesh.properties").core_settings(bpy.context.scene.hybrid_mesh)
    assert settings == module("core.settings").preset("draft")


@pytest.mark.parametrize("features", ["auto", "none", 5.0, 32.5, 40.0, 175.0])
def test_sharp_edges_in_settings_and_properties_are_the_same(features):
    properties, scene = module("features.remesh.properties"), bpy.context.scene.hybrid_mesh
    settings = module("core.settings").RemeshSettings(features=features)
    properties.apply_settings(scene, settings)
    assert scene.features == ("ANGLE" if isinstance(features, float) else features.upper())
    assert properties.core_settings(scene).features == features


def test_the_angle_of_sharp_edges_has_bounds_and_a_default():
    scene = bpy.context.scene.hybrid_mesh
    core_settings = module("features.remesh.properties").core_settings
    assert core_settings(scene).features == "auto"
    scene.features = "ANGLE"
    assert core_settings(scene).features == 40
    for angle, kept in ((0, 5), (math.pi, 175)):
        scene.feature_angle = angle
        assert core_settings(scene).features == kept


def test_presets_leave_sharp_edges_to_the_surface(world):
    bpy.context.scene.hybrid_mesh.features = "NONE"
    assert bpy.ops.hybrid_mesh.preset(name="STANDARD") == {"FINISHED"}
    assert bpy.context.scene.hybrid_mesh.features == "AUTO"


def test_operator_and_panel_have_the_same_settings():
    properties = module("features.remesh.properties")
    operator = bpy.ops.hybrid_mesh.remesh.get_rna_type().properties
    for name in properties.SETTING_NAMES:
        assert name in operator and name in bpy.context.scene.hybrid_mesh.bl_rna.properties


def test_a_cancelled_job_ends_within_half_a_second(world):
    source = world.scan(subdivisions=7)  # 40,962 vertices
    meshes = module("bridge.meshes")
    mesh = meshes.read_source(source, bpy.context.evaluated_depsgraph_get()).mesh
    settings = module("core.settings").RemeshSettings(vertices=50000).native()
    for delay in (0.0, 0.2, 0.7, 1.5):
        job = world.native().start_remesh(*mesh, settings)
        time.sleep(delay)
        began = time.monotonic()
        job.cancel()
        assert job.wait(5)
        assert time.monotonic() - began < 0.5, f"cancelled after {delay} s in stage {job.stage}"


def test_unregister_ends_what_runs(world):
    source = world.scan(subdivisions=6)
    mesh = module("bridge.meshes").read_source(source, bpy.context.evaluated_depsgraph_get()).mesh
    job = world.native().start_remesh(*mesh, module("core.settings").RemeshSettings(vertices=50000).native())
    package = module("")
    package.unregister()
    try:
        assert job.done
        assert not hasattr(bpy.types.Scene, "hybrid_mesh")
    finally:
        package.register()
    assert bpy.ops.hybrid_mesh.remesh.poll()
