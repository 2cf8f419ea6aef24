# SPDX-License-Identifier: GPL-3.0-or-later
"""UV maps of the source on the levels: cut where the source's are, and no face across a seam."""

import bpy
import numpy
import pytest
import textures

QUICK = {"effort": "QUICK"}
SHAPES = {
    "torus": (1000, lambda: bpy.ops.mesh.primitive_torus_add()),
    "cube": (800, lambda: bpy.ops.mesh.primitive_cube_add()),
    "sphere": (2000, lambda: bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12)),
    "cylinder": (800, lambda: bpy.ops.mesh.primitive_cylinder_add(vertices=24)),
    "monkey": (3000, lambda: bpy.ops.mesh.primitive_monkey_add()),
}
SMEARED = {"monkey": 4}  # A few of its triangles are larger than a quad and stand against one another.


@pytest.mark.parametrize("shape", SHAPES)
def test_a_checker_map_looks_the_same(world, shape):
    vertices, add = SHAPES[shape]
    add()
    source = bpy.context.object
    name = source.data.uv_layers.active.name
    _, levels, _ = world.remesh(source, vertices=vertices, **QUICK)
    made = levels[-1]
    assert made.data.uv_layers.active.name == name and made.data.uv_layers[name].active_render
    assert textures.smeared_faces(source, made, name) <= SMEARED.get(shape, 0)
    assert textures.checker_difference(source, made, name) <= 0.02


def give_atlas(obj, count):
    """A UV map with `count` islands, each the faces nearest to one of as many places, seen from outside, in a cell of its own."""
    mesh = obj.data
    centers = numpy.array([polygon.center for polygon in mesh.polygons])
    random = numpy.random.default_rng(2)
    places = centers[random.choice(len(centers), count, replace=False)]
    for _ in range(5):
        label = numpy.linalg.norm(centers[:, None] - places, axis=2).argmin(1)
        places = numpy.array([centers[label == number].mean(0) for number in range(count)])
    for layer in list(mesh.uv_layers):
        mesh.uv_layers.remove(layer)
    layer, side = mesh.uv_layers.new(name="atlas"), int(numpy.ceil(count**0.5))
    cells = numpy.zeros((len(mesh.loops), 2))
    for number in range(count):
        outward = places[number] / numpy.linalg.norm(places[number])
        axes = numpy.linalg.svd(outward[None])[2][1:]
        corners = numpy.array([corner for face in numpy.nonzero(label == number)[0] for corner in mesh.polygons[face].loop_indices])
        seen = numpy.array([mesh.vertices[mesh.loops[corner].vertex_index].co for corner in corners]) @ axes.T
        seen -= seen.min(0)
        cells[corners] = (numpy.array(divmod(number, side)) + 0.05 + 0.9 * seen / seen.max()) / side
    layer.data.foreach_set("uv", cells.ravel())
    return layer.name


def test_a_scan_with_an_atlas_keeps_its_islands(world, capfd):
    source = world.scan(subdivisions=3)
    name = give_atlas(source, 40)
    _, levels, _ = world.remesh(source, vertices=8000, **QUICK)
    final = levels[-1]
    assert textures.checker_difference(source, final, name) <= 0.02
    assert textures.smeared_faces(source, final, name) == 0
    islands = textures.islands_of_faces(source, final, name)
    assert all(len(found) == 1 and None not in found for found in islands)  # nor anything beside an island
    assert len(set.union(*islands)) == 40
    # The base's faces are as large as the islands.
    assert [level.data.uv_layers.active.name for level in (levels[0], final)] == ["patches", name]
    assert f"the UV map '{name}' cannot serve: most faces lie across its seams on N0" in capfd.readouterr().out


def test_a_map_without_area_cannot_serve(world, capfd):
    source = world.scan(subdivisions=3)
    layer = source.data.uv_layers.active
    layer.data.foreach_set("uv", [0.5] * (2 * len(source.data.loops)))
    source.data.update()
    _, levels, _ = world.remesh(source, vertices=500, **QUICK)
    assert levels[-1].data.uv_layers.active.name == "patches"
    assert "most of its faces have no area in it" in capfd.readouterr().out
