# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen of hybrid meshes: edges, colours, levels, and what is said of them."""

import bpy
import numpy

from conftest import module


def colors_of(preview):
    return preview.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.color_attributes.active_color.name


def test_what_is_shown(world):
    display, view = bpy.context.scene.hybrid_mesh_display, module("bridge.levels")
    source = world.scan(subdivisions=3)
    collection, levels, preview = world.remesh(source, vertices=400, effort="QUICK")
    assert display.mode == "QUADS" and preview.show_wire and preview.show_all_edges
    assert bpy.ops.hybrid_mesh.toggle_quads() == {"FINISHED"}
    assert display.mode == "SHADED" and not preview.show_wire
    for mode, name in (("PATCHES", "patch_color"), ("ERROR", "error_color"), ("STRETCH", "stretch_color")):
        display.mode = mode
        assert colors_of(preview) == name and not preview.show_wire
    assert bpy.ops.hybrid_mesh.toggle_quads() == {"FINISHED"}
    assert display.mode == "STRETCH" and preview.show_wire
    # A patch has one colour, and there are several.
    mesh = levels[1].data
    patch, color = (module("bridge.meshes").get_attribute(mesh, name) for name in ("patch", "patch_color"))
    of_faces = color.reshape(-1, 4, 4)
    assert (of_faces == of_faces[:, :1]).all() and len(numpy.unique(of_faces[:, 0], axis=0)) > 3
    assert all(len(numpy.unique(of_faces[patch == number], axis=(0))) for number in set(patch))
    # What is farther off is redder than grey; the coarse level is farther off than the fine one, and one that was moved more so.
    def red(level):
        return module("bridge.meshes").get_attribute(level.data, "error_color")

    grey = numpy.array([(0.8, 0.8, 0.78, 1)])
    off = [numpy.abs(red(level) - grey).mean() for level in (levels[0], levels[-1])]
    assert off[0] > off[1]
    levels[-1].data.vertices[0].co *= 2
    display.mode = "ERROR"
    assert numpy.allclose(red(levels[-1])[0], (0.65, 0.03, 0.03, 1), atol=0.01)
    # Levels by steps, as far as there are some.
    for step, shown in ((-1, len(levels) - 2), (-100, 0), (-1, 0), (1, 1)):
        assert bpy.ops.hybrid_mesh.step_level(step=step) == {"FINISHED"}
        assert view.level_of(preview) == shown
    lines = module("features.display.legend").lines(bpy.context)
    assert lines[0] == (None, f"scan  N1  {len(levels[1].data.polygons):,} faces") and len(lines) == 6 and "1 %) and more" in lines[2][1]
    # Without its source there is no distance to it: that is no reason to show nothing else.
    bpy.data.objects.remove(source)
    display.mode = "SHADED"
    display.mode = "ERROR"
    assert "not in the scene" in module("features.display.properties").show(bpy.context, collection)
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.hybrid_mesh.step_level.poll() and module("features.display.legend").lines(bpy.context) == []


def test_the_figures_are_those_of_what_is_shown(world):
    panel, bridge = module("features.levels.panel"), module("bridge.levels")
    collection, levels, preview = world.remesh(world.scan(subdivisions=3), vertices=400, effort="QUICK")
    rows = panel.level_rows(collection)
    assert [(row[0], row[1]) for row in rows] == [(f"N{number}", len(level.data.vertices)) for number, level in enumerate(levels)]
    assert all(row[2] for row in rows)
    bridge.set_level(preview, 1)
    assert panel._read_level(bpy.context, collection) == levels[1]
    levels[0].hide_set(False)
    world.select(levels[0])
    assert panel._read_level(bpy.context, collection) == levels[0]


def test_settings_that_are_off_are_automatic(world):
    settings = bpy.context.scene.hybrid_mesh
    assert settings.use_vertices and not settings.use_error and not settings.use_levels
    settings.use_levels = True
    assert settings.levels == 3
    settings.levels = 5
    settings.use_levels = True  # it is on already
    assert settings.levels == 5
    settings.use_levels = settings.use_vertices = False
    assert settings.levels == -1 and settings.vertices == 0


def test_lengths_are_in_the_units_of_the_scene():
    text, scene = module("bridge.units").length_text, bpy.context.scene
    scene.unit_settings.system = "METRIC"
    assert text(scene, 0.0009) == "0.9 mm"
    scene.unit_settings.scale_length = 0.001
    assert text(scene, 0.9) == "0.9 mm"
    scene.unit_settings.system = "NONE"
    assert text(scene, 0.12345) == "0.123"
