# SPDX-License-Identifier: GPL-3.0-or-later
import json

import bpy
import numpy
import pytest

from conftest import module


def suzanne(world, **transform):
    bpy.ops.mesh.primitive_monkey_add(size=2)
    obj = bpy.context.object
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = 2
    return world.placed(obj, **transform)


def check_symmetric(obj, axis=0, tolerance=0.0):
    """Whether the vertices and faces of a mesh object are their own mirror images in the object's space, and its middle is closed."""
    mesh = obj.data
    points = module("bridge.meshes").values_of(mesh.vertices, "co", 3).astype(float) + 0.0
    mirrored = points.copy()
    mirrored[:, axis] = 0.0 - mirrored[:, axis]
    image = numpy.empty(len(points), dtype=int)
    for start in range(0, len(points), 500):
        apart = numpy.abs(points[None] - mirrored[start : start + 500, None]).max(axis=2)
        image[start : start + 500] = apart.argmin(axis=1)
        assert (apart.min(axis=1) <= tolerance).all()
    assert (image[image] == numpy.arange(len(points))).all()
    faces = {frozenset(polygon.vertices) for polygon in mesh.polygons}
    assert {frozenset(image[list(face)].tolist()) for face in faces} == faces
    counts = {}
    for polygon in mesh.polygons:
        for edge in polygon.edge_keys:
            counts[edge] = counts.get(edge, 0) + 1
    middle = [count for edge, count in counts.items() if (image[list(edge)] == edge).all()]
    assert middle and set(middle) == {2}


def report_of(world, obj):
    return json.loads(world.hierarchy(obj)[0].hybrid_mesh.report)


def test_a_scan_is_symmetric_on_every_level(world):
    # Suzanne's eyes are pieces of their own that the plane does not touch.
    source = suzanne(world)
    _, levels, _ = world.remesh(source, symmetry="X", vertices=2500, effort="QUICK")
    assert len(levels) > 1
    for level in levels:
        check_symmetric(level)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_axes_are_those_of_the_object(world, axis):
    bpy.ops.mesh.primitive_torus_add(major_segments=40, minor_segments=20)
    source = world.placed(bpy.context.object, location=(3, -2, 1), rotation_euler=(0.4, 1.1, -0.3), scale=(1, -1.5, 0.8))
    _, levels, _ = world.remesh(source, symmetry="XYZ"[axis], vertices=1500, effort="QUICK")
    for level in levels:
        check_symmetric(level, axis, 1e-5)


def test_a_mirror_modifier_says_the_axis(world):
    source = world.scan()
    mesh = source.data
    for vertex in mesh.vertices:
        vertex.co.x += 0.3
    modifier = source.modifiers.new("Mirror", "MIRROR")
    modifier.use_axis = (True, False, False)
    modifier.use_bisect_axis = (True, False, False)
    modifier.use_clip = True
    _, levels, _ = world.remesh(source, symmetry="AUTO", vertices=1500)
    for level in levels:
        check_symmetric(level)


def test_a_sheared_axis_is_refused(world):
    parent = bpy.data.objects.new("parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale = (1, 3, 1)
    source = world.scan(rotation_euler=(0, 0, 0.6))
    source.parent = parent
    world.select(source)
    with pytest.raises(RuntimeError, match="sheared"):
        bpy.ops.hybrid_mesh.remesh(vertices=1000, symmetry="X")


def test_the_panel_has_it_and_it_is_off(world):
    settings = bpy.context.scene.hybrid_mesh
    assert settings.symmetry == "NONE" and settings.symmetry_side == "POSITIVE"
    core = module("features.remesh.properties").core_settings(settings)
    assert core.symmetry == "none" and "symmetry" not in core.reported()
