# SPDX-License-Identifier: GPL-3.0-or-later
"""The head among the samples: six quads drawn on it, cubes on its neck's boundary, and its nose laid out anew."""

import collections
import sys

import bpy
import numpy
import pytest

from conftest import module
from layout_tools import draw, layout_of, read, state
from test_layout_remesh import address
from test_samples import SAMPLES

sys.path.insert(0, str(SAMPLES.parent / "scripts"))
import nose_layout  # noqa: E402


def opened(name):
    bpy.ops.wm.open_mainfile(filepath=str(SAMPLES / f"{name}.blend"))
    return bpy.data.objects["head"]


def test_twelve_curves_that_a_file_brings_along_are_six_quads(world):
    head = opened("head_layout")
    lines = read(layout_of(head))
    assert len(lines) == 12 and layout_of(head).hybrid_mesh_layout.surface == head
    world.select(head)
    assert bpy.ops.hybrid_mesh.check_layout() == {"FINISHED"}
    assert layout_of(head).hybrid_mesh_layout.summary == "8 nodes, 12 curves, 6 faces" and not len(layout_of(head).hybrid_mesh_layout.problems)
    bpy.context.scene.hybrid_mesh.vertices = 6200
    assert bpy.ops.hybrid_mesh.remesh_layout() == {"FINISHED"}
    collection, levels, _ = world.hierarchy(head)
    assert [len(level.data.polygons) for level in levels] == [6 * 4**number for number in range(6)]
    report = module("features.levels.properties").report_of(collection)
    assert (report["base"]["quads"], report["final"]["irregular_vertices"]["base"], report["final"]["scaled_jacobian"]["inverted"]) == (6, 8, 0)
    errors = [world.distance(head, level)["l2"] for level in levels]
    assert errors[-1] < 2e-3 and all(fine < 0.6 * coarse for coarse, fine in zip(errors[1:-1], errors[2:]))
    # Each node of the base lies nearest to another one that was drawn.
    nodes = numpy.unique(numpy.round([line[end] for line in lines for end in (0, -1)], 3), axis=0)
    corners = world.evaluated(levels[0])[0]
    assert len(nodes) == len(corners) == 8
    assert sorted(numpy.linalg.norm(corners[:, None] - nodes, axis=2).argmin(axis=1)) == list(range(8))


def boundary(obj):
    """Vertices of the boundary, in their order around it."""
    faces = collections.Counter(key for polygon in obj.data.polygons for key in polygon.edge_keys)
    beside = collections.defaultdict(list)
    for a, b in (key for key, count in faces.items() if count == 1):
        beside[a].append(b)
        beside[b].append(a)
    found = [min(beside)]
    while len(found) < len(beside):
        found.append(next(vertex for vertex in beside[found[-1]] if vertex not in found[-2:] and (len(found) < 3 or vertex != found[0])))
    return found


def four_corners(head):
    rim = boundary(head)
    return [rim[corner] for corner in nose_layout.four_corners(numpy.array([head.data.vertices[vertex].co for vertex in rim]))]


def select_vertices(obj, vertices):
    for elements in (obj.data.polygons, obj.data.edges, obj.data.vertices):
        for element in elements:
            element.select = False
    for vertex in vertices:
        obj.data.vertices[vertex].select = True


def from_boundary(world, head, cubes, vertices=(), **settings):
    """Remesh from Boundary, in Edit Mode where vertices are given."""
    world.select(head)
    for key, value in {"vertices": 0, "hide_source": False, **settings}.items():
        setattr(bpy.context.scene.hybrid_mesh, key, value)
    if vertices:
        select_vertices(head, vertices)
        bpy.context.scene.tool_settings.mesh_select_mode = (True, False, False)
        bpy.ops.object.mode_set(mode="EDIT")
    assert bpy.ops.hybrid_mesh.remesh_boundary(cubes=cubes) == {"FINISHED"}
    assert bpy.context.mode == "OBJECT"
    return world.hierarchy(head)[1]


def test_a_base_of_three_cubes_on_four_vertices(world):
    head = world.placed(opened("head"), location=(1, 2, 3), scale=(2, 1.5, 1), rotation_euler=(0.1, 0.2, 0.3))
    four = four_corners(head)
    select_vertices(head, four)
    bpy.ops.object.mode_set(mode="EDIT")  # from which on Blender may keep the selection as attributes
    bpy.ops.object.mode_set(mode="OBJECT")
    before = state(head)
    levels = from_boundary(world, head, 3, four, levels=2)
    assert state(head) == before
    assert [len(level.data.polygons) for level in levels] == [13, 52, 208]
    wanted = numpy.array([head.matrix_world @ head.data.vertices[vertex].co for vertex in four])
    corners = world.evaluated(levels[0])[0][boundary(levels[0])]
    # They may slide along the boundary to where the map is even.
    away = numpy.linalg.norm(corners[:, None] - wanted, axis=2)
    assert len(corners) == 4 and sorted(away.argmin(axis=1)) == [0, 1, 2, 3] and away.min(axis=1).max() < 0.1 * numpy.linalg.norm(numpy.ptp(wanted, axis=0))
    assert world.distance(head, levels[-1])["l2"] < 0.02


def test_how_many_cubes_is_found(world):
    levels = from_boundary(world, opened("head"), 0, levels=1)
    assert len(levels[0].data.polygons) % 4 == 1 and 5 <= len(levels[0].data.polygons) <= 29


def test_what_is_no_base_on_a_boundary(world):
    head = opened("head")
    around = boundary(head)
    inner = next(vertex.index for vertex in head.data.vertices if vertex.index not in set(around))
    for vertices, words in (([around[0]], "1 vertex is selected"), (around[:3], "3 vertices are selected"), ([*around[:3], inner], "1 of the four .* is not on")):
        with pytest.raises(RuntimeError, match=words):
            from_boundary(world, head, 1, vertices)
        assert bpy.context.mode == "EDIT_MESH"
        bpy.ops.object.mode_set(mode="OBJECT")
    with pytest.raises(RuntimeError, match="disk|boundary"):
        from_boundary(world, opened("head_layout"), 1)
    assert not any(collection.name.endswith("hierarchy") for collection in bpy.data.collections)


def test_a_nose_laid_out_anew_is_less_stretched(world):
    head = opened("head")
    levels = from_boundary(world, head, 3, four_corners(head), levels=5)
    level, fine = levels[3], levels[5]
    (points, _, indices), (fine_points, _, fine_indices) = world.evaluated(level), world.evaluated(fine)
    uv, fine_uv = (numpy.array([one.uv for one in obj.data.uv_layers["patches"].data]) for obj in (level, fine))
    stretch, anisotropy = (module("bridge.meshes").get_attribute(level.data, name) for name in ("stretch", "anisotropy"))
    scan = world.evaluated(head)[0]
    block = nose_layout.block_at(points, indices.reshape(-1, 4), scan[scan[:, 1].argmin()], stretch, 2, 3)
    # What is selected is the most stretched part of the face.
    assert stretch[block.faces].max() > 1.5
    kept = {address(level, face): stretch[face] for face in set(range(len(stretch))) - set(block.faces) - set(block.around(1))}
    for polygon in level.data.polygons:
        polygon.select = polygon.index in block.faces
    level.hide_set(False)
    draw(level, nose_layout.skin_lines(block, nose_layout.places_on(uv, fine_points[fine_indices], fine_uv), steps=4))
    assert bpy.ops.hybrid_mesh.repatch_region(buffer_rings=1) == {"FINISHED"}
    hierarchy = bpy.context.object.hybrid_mesh.hierarchy
    (operation,) = module("features.levels.properties").report_of(hierarchy)["levels"][3]["irregular_ops"]
    assert (operation["removed_quads"], operation["new_quads"]) == (6, 16)
    after = {obj.hybrid_mesh.level: obj for obj in hierarchy.objects if obj.hybrid_mesh.role == "LEVEL"}
    new_stretch, new_anisotropy, new = (module("bridge.meshes").get_attribute(after["N3"].data, name) for name in ("stretch", "anisotropy", "irregular"))
    assert new.sum() == 16
    assert new_stretch[new].max() < 0.7 * stretch[block.faces].max()
    assert numpy.percentile(new_stretch[new], 95) < 0.7 * numpy.percentile(stretch[block.faces], 95)
    assert numpy.median(new_anisotropy[new]) < 1.1 * numpy.median(anisotropy[block.faces])
    # Beyond the buffer ring everything is as it was.
    found = {address(after["N3"], face): new_stretch[face] for face in range(len(new_stretch))}
    scale = numpy.median([found[one] / value for one, value in kept.items()])  # stretch is relative to the level's median
    assert len(kept) > 700 and all(abs(found[one] / scale - value) < 1e-3 * value for one, value in kept.items())
    assert world.distance(head, after["N5"])["l2"] < 1e-3
