# SPDX-License-Identifier: GPL-3.0-or-later
"""The head among the samples: six quads drawn on it."""

import bpy
import numpy

from conftest import module
from test_layouts import layout_of, read
from test_samples import SAMPLES


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
