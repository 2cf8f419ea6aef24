# SPDX-License-Identifier: GPL-3.0-or-later
"""Why a result is poor: reported, listed in the panel, and shown where it is."""

import json
import types

import bpy
import mathutils
import numpy
import pytest

from conftest import module


def with_needle(world, **transform):
    """A ball with a needle up to x = 5, of which a few hundred quads lose the tip."""
    obj = world.scan(subdivisions=5)
    for vertex in obj.data.vertices:
        direction = vertex.co.normalized()
        vertex.co = direction + mathutils.Vector((4 * numpy.exp(-((direction - mathutils.Vector((1, 0, 0))).length_squared) / 0.05**2), 0, 0))
    return world.placed(obj, **transform)


def tip_of(obj):
    return obj.matrix_world @ max((vertex.co for vertex in obj.data.vertices), key=lambda point: point.x)


def reasons_of(collection):
    return module("core.report").reasons(module("features.levels.properties").report_of(collection))


def poor(world, **transform):
    """The needle's source and the collection, with its one reason that has a place."""
    source = with_needle(world, **transform)
    collection, _, preview = world.remesh(source, vertices=300, features="NONE")
    index = next(i for i, reason in enumerate(reasons_of(collection)) if reason["what"] == "hausdorff")
    return source, collection, preview, index


PLACES = [{}, {"location": (50, -20, 3), "rotation_euler": (0.3, 1.1, -2), "scale": (2, -0.5, 1)}]


@pytest.mark.parametrize("transform", PLACES)
def test_a_reason_is_shown_where_it_is(world, transform):
    source, _, preview, index = poor(world, **transform)
    size = max(source.dimensions)
    assert bpy.ops.hybrid_mesh.show_reason(index=index) == {"FINISHED"}
    assert (bpy.context.scene.cursor.location - tip_of(source)).length < 1e-4 * size
    # The hierarchy is moved: the place goes with it.
    move = mathutils.Matrix.Translation((7, 8, -9)) @ mathutils.Matrix.Rotation(1, 4, "Y")
    preview.matrix_world = move @ preview.matrix_world
    bpy.context.view_layer.update()
    assert bpy.ops.hybrid_mesh.show_reason(index=index) == {"FINISHED"}
    assert (bpy.context.scene.cursor.location - move @ tip_of(source)).length < 1e-4 * size


def test_views_are_framed_where_there_are_some(world, capfd):
    source, _, _, index = poor(world)
    areas = list(bpy.context.window.screen.areas) if bpy.context.window else []
    for area in areas:
        area.type = "VIEW_3D"
    assert bpy.ops.hybrid_mesh.show_reason(index=index) == {"FINISHED"}
    for area in areas:
        view = area.spaces.active.region_3d
        assert (view.view_location - tip_of(source)).length < 1e-3 and 0 < view.view_distance < 5
    assert ("no 3D view" in capfd.readouterr().out) == (not areas)
    for area in areas:
        area.type = "CONSOLE"
    bpy.context.scene.cursor.location = (0, 0, 0)
    # No `screen`: Blender 5 crashes where that one is None.
    with bpy.context.temp_override(window=None, area=None, region=None):
        assert bpy.ops.hybrid_mesh.show_reason(index=index) == {"FINISHED"}
    assert (bpy.context.scene.cursor.location - tip_of(source)).length < 1e-3
    assert "no 3D view" in capfd.readouterr().out


def test_what_cannot_be_shown_is_said(world):
    scan = world.scan()
    assert not bpy.ops.hybrid_mesh.show_reason.poll()
    collection, _, _ = world.remesh(scan, vertices=5000, base="MIN", semi_regular=True)
    assert [reason["what"] for reason in reasons_of(collection)] == ["vertices"]
    with pytest.raises(RuntimeError, match="no place"):
        bpy.ops.hybrid_mesh.show_reason(index=0)
    with pytest.raises(RuntimeError, match="no number 1"):
        bpy.ops.hybrid_mesh.show_reason(index=1)


def test_reasons_are_reported_and_with_strict_settings_an_error(world, capfd):
    source = with_needle(world)
    world.select(source)
    assert bpy.ops.hybrid_mesh.remesh(vertices=300) == {"FINISHED"}
    assert "Warning: scan: poor: the mesh is up to" in capfd.readouterr().out
    world.select(source)
    with pytest.raises(RuntimeError, match="scan: poor: the mesh is up to"):
        bpy.ops.hybrid_mesh.remesh(vertices=300, strict=True)
    # It is there all the same.
    assert len([collection for collection in bpy.data.collections if collection.name.startswith("scan hierarchy")]) == 2
    world.select(world.scan("good"))
    assert bpy.ops.hybrid_mesh.remesh(vertices=2000, strict=True) == {"FINISHED"}


class Recorder:
    """Stands in for a layout: what is drawn into it."""

    def __init__(self, drawn=None):
        self.drawn = [] if drawn is None else drawn

    def label(self, text="", icon="NONE"):
        self.drawn.append(text)

    def operator(self, name, text="", icon="NONE", emboss=True):
        self.drawn.append(Properties(name))
        return self.drawn[-1]

    def box(self, **_):
        return Recorder(self.drawn)

    row = column = box


class Properties:
    def __init__(self, name):
        self.name, self.index = name, None


WIDTH = types.SimpleNamespace(region=types.SimpleNamespace(width=300), preferences=types.SimpleNamespace(system=types.SimpleNamespace(ui_scale=1)))


def drawn(report):
    panel, layout = module("features.levels.panel").HYBRID_MESH_PT_levels, Recorder()
    panel._verdict(None, WIDTH, layout, report)
    buttons = [(one.name, one.index) for one in layout.drawn if isinstance(one, Properties)]
    return " ".join(one for one in layout.drawn if isinstance(one, str)), buttons


def test_the_panel_lists_the_reasons_with_a_button_where_there_is_a_place():
    reasons = [{"what": "vertices", "text": "few are used"}, {"what": "hausdorff", "text": "a limb is lost, far out " * 9, "where": [1, 2, 3]}]
    text, buttons = drawn({"verdict": {"result": "poor", "reasons": reasons}})
    assert all(reason["text"].strip() in text for reason in reasons) and text.count("Poor") == 2 and "Good" not in text
    assert buttons == [("hybrid_mesh.show_reason", 1)]
    assert drawn({"verdict": {"result": "good", "reasons": []}}) == ("Good", [])
    for unknown in ({}, {"verdict": None}):
        assert drawn(unknown) == ("", [])


def test_the_verdict_is_kept_in_the_file(world, tmp_path):
    _, collection, _, index = poor(world)
    name, before = collection.name, reasons_of(collection)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "poor.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "poor.blend"))
    assert json.loads(bpy.data.collections[name].hybrid_mesh.report)["verdict"]["reasons"] == before
    assert bpy.ops.hybrid_mesh.show_reason(index=index) == {"FINISHED"}
    assert (bpy.context.scene.cursor.location - mathutils.Vector(before[index]["where"])).length < 1e-3
