# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
import numpy
import pytest

from cube import cube_lines, on_surface
from layout_tools import PLACES, broken_cube, check, distance, draw, drawing, layout_of, parented, read, state, strokes, tolerance


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
