# SPDX-License-Identifier: GPL-3.0-or-later
import itertools
import math

import bmesh
import bpy
import numpy
import pytest

from conftest import module

CORNERS = numpy.array(list(itertools.product((-1.0, 1.0), repeat=3)))
EDGES = [(a, b) for a, b in itertools.combinations(CORNERS, 2) if (a != b).sum() == 1]


def cube(world, name="cube", **transform):
    """Twelve triangles."""
    obj = world.box(name, **transform)
    graph = bmesh.new()
    graph.from_mesh(obj.data)
    bmesh.ops.triangulate(graph, faces=graph.faces[:])
    graph.to_mesh(obj.data)
    graph.free()
    return obj


def points_of(mesh):
    return module("bridge.meshes").values_of(mesh.vertices, "co", 3)


def sharp_edges(mesh):
    """The ends of the edges that are marked as sharp; they are the ones with a crease, and that is full."""
    values_of = module("bridge.meshes").values_of
    marked = values_of(mesh.edges, "use_edge_sharp", 1, bool)
    attribute = mesh.attributes.get("crease_edge")
    crease = values_of(attribute.data, "value", 1) if attribute else values_of(mesh.edges, "crease", 1)
    assert numpy.array_equal(crease, marked.astype(float))
    return values_of(mesh.edges, "vertices", 2, numpy.int32)[marked]


def has_marks(mesh):
    creased = mesh.has_crease_edge if hasattr(mesh, "has_crease_edge") else "crease_edge" in mesh.attributes
    return creased or "sharp_edge" in mesh.attributes or any(edge.use_edge_sharp for edge in mesh.edges) or getattr(mesh, "use_auto_smooth", False)


def check_cube(mesh):
    """Whether the sharp edges are chains along the twelve edges of the cube, from corner to corner, and nothing else."""
    points, edges = points_of(mesh).astype(float), sharp_edges(mesh)
    found = 0
    for a, b in EDGES:
        axis = numpy.nonzero(a != b)[0][0]
        on_it = (numpy.abs(numpy.delete(points - a, axis, axis=1)) < 1e-6).all(axis=1)[edges].all(axis=1)
        assert numpy.ptp(points[edges[on_it], axis], axis=1).sum() == pytest.approx(2, abs=1e-5)
        found += on_it.sum()
    assert found == len(edges)
    assert len(mesh.vertices) - len(mesh.edges) + len(mesh.polygons) == 2  # one closed surface: no vertex is there twice


def flatness(obj):
    """The smallest dot product of a corner's normal and that of its face, as the object is shown."""
    values_of = module("bridge.meshes").values_of
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    try:
        if hasattr(mesh, "corner_normals"):
            normals = values_of(mesh.corner_normals, "vector", 3)
        else:
            mesh.calc_normals_split()
            normals = values_of(mesh.loops, "normal", 3)
        faces = numpy.repeat(values_of(mesh.polygons, "normal", 3), values_of(mesh.polygons, "loop_total", 1, numpy.int32), axis=0)
        return (normals * faces).sum(axis=1).min()
    finally:
        evaluated.to_mesh_clear()


# Where an object mirrors, faces are turned over.
@pytest.mark.parametrize("scale", [(1, 1, 1), (-2, 1, 1.5)])
@pytest.mark.parametrize("refinement", ["UNIFORM", "ADAPTIVE"])
def test_a_cube_has_its_edges_on_every_level(world, scale, refinement):
    _, levels, _ = world.remesh(cube(world, scale=scale), vertices=2000, refinement=refinement)
    assert len(levels) > 2
    for level in levels:
        check_cube(level.data)
        assert all(polygon.use_smooth for polygon in level.data.polygons)


def test_normals_split_at_the_edges_only(world):
    _, levels, preview = world.remesh(cube(world))
    for number, level in enumerate(levels):
        module("bridge.levels").set_level(preview, number)
        assert flatness(level) > 0.9999 and flatness(preview) > 0.9999
    _, levels, preview = world.remesh(cube(world, "without"), features="NONE")
    assert flatness(levels[0]) < 0.9 and flatness(preview) < 0.9


def test_what_is_smooth_has_no_marks(world):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    _, levels, preview = world.remesh(bpy.context.object)
    assert not any(has_marks(obj.data) for obj in (*levels, preview))
    _, levels, preview = world.remesh(cube(world), features="NONE")
    assert not any(has_marks(obj.data) for obj in (*levels, preview))
    _, levels, _ = world.remesh(cube(world, "other"))
    assert all(has_marks(level.data) for level in levels)


def test_marks_of_the_source_itself_do_not_count(world):
    source = world.scan()
    for edge in source.data.edges:
        edge.use_edge_sharp = edge.index % 3 == 0
    _, levels, _ = world.remesh(source)
    assert not any(has_marks(level.data) for level in levels)


@pytest.mark.parametrize("kind", ["SUBSURF", "MULTIRES"])
def test_subdividing_leaves_the_edges_where_they_are(world, kind):
    _, levels, _ = world.remesh(cube(world), base="MIN", vertices=500)
    level = levels[0]
    level.hide_set(False)
    world.select(level)
    quads = len(level.data.polygons)
    if kind == "SUBSURF":
        modifier = level.modifiers["Subdivision Preview"]
        modifier.show_viewport, modifier.levels = True, 2
    else:
        modifier = level.modifiers.new("Multires", "MULTIRES")
        for _ in range(2):
            assert bpy.ops.object.multires_subdivide(modifier="Multires") == {"FINISHED"}
        modifier.levels = 2
    points, offsets, _ = world.evaluated(level)
    assert len(offsets) - 1 == 16 * quads
    # Without creases the corners are far inside.
    assert numpy.abs(numpy.abs(points).max(axis=1) - 1).max() < 1e-5
    assert max(numpy.abs(points - corner).max(axis=1).min() for corner in CORNERS) < 1e-5


def test_the_levels_of_a_file_have_them(world, tmp_path):
    points, offsets, indices = module("bridge.meshes").read_source(cube(world), bpy.context.evaluated_depsgraph_get()).mesh
    path = str(tmp_path / "cube.hmesh")
    world.native().remesh(points, offsets, indices, {"vertices": 1000}).hierarchy.save(path)
    built = module("bridge.blend_files").build(path, "read")
    for level in built.levels:
        check_cube(level.data)
    assert flatness(built.preview) > 0.9999


def test_the_angle_counts_and_is_reported(world):
    reports = module("features.levels.properties").report_of
    collection, levels, _ = world.remesh(cube(world), features="ANGLE", feature_angle=math.radians(80))
    assert reports(collection)["settings"]["features"] == 80
    check_cube(levels[-1].data)
    collection, levels, _ = world.remesh(cube(world, "flat"), features="ANGLE", feature_angle=math.radians(100))
    assert reports(collection)["settings"]["features"] == 100 and not has_marks(levels[-1].data)
    collection, _, _ = world.remesh(cube(world, "auto"))
    assert reports(collection)["settings"]["features"] == "auto"
