# SPDX-License-Identifier: GPL-3.0-or-later
import bpy

from conftest import module


def shown(preview):
    return len(preview.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons)


def test_the_preview_switches_live(world):
    bridge = module("bridge.levels")
    _, levels, preview = world.remesh(world.scan())
    sizes = [len(level.data.polygons) for level in levels]
    assert bridge.level_of(preview) == len(levels) - 1 and shown(preview) == sizes[-1]
    for number, size in enumerate(sizes):
        bridge.set_level(preview, number)
        assert shown(preview) == size
    bridge.set_level(preview, 99)
    assert shown(preview) == sizes[-1]


def test_the_preview_shows_what_the_level_is(world):
    bridge = module("bridge.levels")
    _, levels, preview = world.remesh(world.scan(location=(3, 2, 1), scale=(1, -2, 1)))
    bridge.set_level(preview, 1)
    assert world.distance(levels[1], preview)["hausdorff"] < 1e-6
    mesh = preview.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    assert mesh.color_attributes.active_color.name == "stretch_color"
    assert "stretch" in mesh.attributes and "patches" in mesh.uv_layers


def test_renaming_and_adding_objects_changes_nothing(world):
    bridge = module("bridge.levels")
    collection, levels, preview = world.remesh(world.scan())
    levels[0].name = "zzz"
    levels[-1].name = "aaa"
    collection.objects.link(bpy.data.objects.new("0 added", bpy.data.meshes.new("added")))
    bridge.set_level(preview, 0)
    assert shown(preview) == len(levels[0].data.polygons)


def test_editing_a_level_is_seen_in_the_preview(world):
    bridge = module("bridge.levels")
    _, levels, preview = world.remesh(world.scan())
    bridge.set_level(preview, 0)
    levels[0].data.vertices[0].co.x += 10
    levels[0].data.update()
    points, _, _ = world.evaluated(preview)
    assert points[:, 0].max() > 5


def test_the_levels_are_hidden_and_the_preview_is_not(world):
    _, levels, preview = world.remesh(world.scan())
    assert all(level.hide_get() and level.hide_render for level in levels)
    assert preview.visible_get() and not preview.hide_render


def test_moving_the_preview_moves_what_it_shows(world):
    _, levels, preview = world.remesh(world.scan())
    preview.location.x += 100
    bpy.context.view_layer.update()
    points, _, _ = world.evaluated(preview)
    assert points[:, 0].min() > 90


def test_operator(world):
    source = world.scan()
    _, levels, preview = world.remesh(source)
    assert bpy.ops.hybrid_mesh.show_level(level=1) == {"FINISHED"}
    assert shown(preview) == len(levels[1].data.polygons)
    world.select(source)
    assert bpy.ops.hybrid_mesh.show_level(level=0) == {"FINISHED"}
    assert shown(preview) == len(levels[0].data.polygons)
    preview.modifiers.clear()
    try:
        bpy.ops.hybrid_mesh.show_level(level=0)
    except RuntimeError as error:
        assert "modifier" in str(error)
    else:
        raise AssertionError("finished without a modifier")


def test_a_saved_file_keeps_everything(world, tmp_path):
    source = world.scan("Größe 猫")
    collection, levels, _ = world.remesh(source)
    sizes, report = [len(level.data.polygons) for level in levels], collection.hybrid_mesh.report
    path = str(tmp_path / "Größe 猫.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.open_mainfile(filepath=path)
    collection, levels, preview = world.hierarchy(bpy.data.objects["Größe 猫"])
    assert [len(level.data.polygons) for level in levels] == sizes and collection.hybrid_mesh.report == report
    module("bridge.levels").set_level(preview, 0)
    assert shown(preview) == sizes[0]


def test_subdivision_preview_works(world):
    _, levels, _ = world.remesh(world.scan())
    levels[1].modifiers["Subdivision Preview"].show_viewport = True
    levels[1].hide_set(False)
    graph = bpy.context.evaluated_depsgraph_get()
    assert len(levels[1].evaluated_get(graph).data.polygons) == 4 * len(levels[1].data.polygons)


def test_panels_draw_for_every_kind_of_object(world):
    """Poll and the read-out, for what draws only in a window."""
    panel = bpy.types.HYBRID_MESH_PT_levels
    properties = module("features.levels.properties")
    source = world.scan()
    assert properties.hierarchy_of(source) is None and properties.hierarchy_of(None) is None
    collection, levels, preview = world.remesh(source)
    for obj in (source, levels[0], preview):
        assert properties.hierarchy_of(obj) == collection
    assert panel.bl_category == "Hybrid Mesh"
    collection.hybrid_mesh.report = "{broken"
    assert properties.report_of(collection) == {}
