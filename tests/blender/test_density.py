# SPDX-License-Identifier: GPL-3.0-or-later
import json
import math

import bpy
import numpy
import pytest

from conftest import module

MET = math.log(1.25)


def heights(obj):
    """z of every vertex, from 0 below to 1 above."""
    z = module("bridge.meshes").values_of(obj.data.vertices, "co", 3)[:, 2].astype(float)
    return (z - z.min()) / numpy.ptp(z)


def in_group(obj, weights, name="dense"):
    group = obj.vertex_groups.new(name=name)
    for vertex, weight in enumerate(weights):
        if not math.isnan(weight):
            group.add([vertex], float(weight), "REPLACE")
    return group


def density_of(world, obj):
    properties = module("features.levels.properties")
    return properties.report_of(world.hierarchy(obj)[0])["density"]


def upper_share(level):
    """The part of a level's vertices in the upper half of its height."""
    return (heights(level) > 0.5).mean()


def read(obj, name):
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    return module("bridge.meshes").read_source(obj, graph, density=module("bridge.density").reader(name)).density


@pytest.mark.parametrize("refinement", ["UNIFORM", "ADAPTIVE"])
def test_a_vertex_group_makes_quads_smaller(world, refinement):
    scan = world.scan(subdivisions=5, scale=(2, 2, -2), location=(5, 0, 0))
    in_group(scan, 0.25 + 0.5 * heights(scan))
    _, levels, _ = world.remesh(scan, refinement=refinement, density="dense")
    made = density_of(world, scan)
    assert made["name"] == "dense" and made["largest"] / made["smallest"] == pytest.approx(4, rel=1e-3)
    assert upper_share(levels[-1]) > 0.7
    if refinement == "UNIFORM":
        assert made["met"] <= MET
        world.remesh(scan, refinement=refinement)
        assert 0.35 < upper_share(world.hierarchy(scan)[1][-1]) < 0.65


def test_vertices_outside_the_group_are_as_without(world):
    box = world.box()
    in_group(box, [math.nan, 1, math.nan, 0, 0.25, math.nan, 1, math.nan])
    assert numpy.allclose(read(box, "dense"), [0.5, 1, 0.5, 0, 0.25, 0.5, 1, 0.5])


def test_attributes_of_points_corners_and_faces(world):
    box = world.box()
    meshes = module("bridge.meshes")
    values = numpy.linspace(0, 1, 8)
    meshes.set_attribute(box.data, "points", "FLOAT", "POINT", values)
    assert numpy.allclose(read(box, "points"), values)
    meshes.set_attribute(box.data, "mask", "BOOLEAN", "POINT", values > 0.5)
    assert numpy.array_equal(read(box, "mask"), values > 0.5)
    # Each vertex of a cube has three faces, and a corner in each.
    sides = numpy.arange(6) / 5
    meshes.set_attribute(box.data, "faces", "FLOAT", "FACE", sides)
    around = [[sides[face.index] for face in box.data.polygons if vertex in face.vertices] for vertex in range(8)]
    assert numpy.allclose(read(box, "faces"), numpy.mean(around, axis=1))
    corners = meshes.values_of(box.data.loops, "vertex_index", 1, numpy.int32)
    meshes.set_attribute(box.data, "corners", "FLOAT", "CORNER", values[corners])
    assert numpy.allclose(read(box, "corners"), values)
    for kind, domain, where in (("FLOAT_COLOR", "POINT", slice(None)), ("BYTE_COLOR", "CORNER", corners)):
        attribute = box.data.attributes.new(kind, kind, domain)
        grey = numpy.repeat(values[where, None], 4, axis=1).astype(numpy.float32)
        attribute.data.foreach_set("color_srgb", grey.ravel())
        assert numpy.allclose(read(box, kind), values, atol=0.01)


def test_what_cannot_be_read_is_said_by_name(world):
    box = world.box()
    meshes = module("bridge.meshes")
    values = numpy.zeros(8)
    values[3] = math.nan
    meshes.set_attribute(box.data, "broken", "FLOAT", "POINT", values)
    meshes.set_attribute(box.data, "edges", "FLOAT", "EDGE", numpy.zeros(12))
    meshes.set_attribute(box.data, "arrows", "FLOAT_VECTOR", "POINT", numpy.zeros((8, 3)))
    for name, said in (("missing", "no attribute 'missing'"), ("broken", "'broken', the density, is not a finite number"), ("edges", "'edges' cannot be"), ("arrows", "'arrows' cannot be")):
        world.select(box)
        with pytest.raises(RuntimeError, match=said):
            bpy.ops.hybrid_mesh.remesh(vertices=500, density=name)
    names = module("bridge.density").names_of(box)
    assert "broken" in names and "edges" not in names and "arrows" not in names


def test_objects_of_a_blend(world, tmp_path, capfd):
    scan = world.scan("painted", subdivisions=5)
    in_group(scan, 0.25 + 0.5 * heights(scan))
    world.box("plain")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    command = ["remesh", str(tmp_path / "scene.blend"), "--output", str(tmp_path / "out"), "--vertices", "2000", "--density", "dense"]
    assert module("core.cli").run(command) == 1
    density = json.loads((tmp_path / "out" / "painted.report.json").read_text())["density"]
    assert density["name"] == "dense" and density["met"] <= MET
    assert "'dense'" in json.loads((tmp_path / "out" / "plain.report.json").read_text())["error"] and "plain" in capfd.readouterr().err
