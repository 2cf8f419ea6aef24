# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of drawn layouts share."""

import bpy
import numpy
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from conftest import module
from cube import cube_lines

PLACES = [
    {},
    {"location": (5, -2, 1), "rotation_euler": (0.4, -1.2, 2.5)},
    {"location": (-3, 7, 2), "rotation_euler": (1.1, 0.2, -0.7), "scale": (0.3, 2, 1.1)},
    {"scale": (-1, 1, 2), "rotation_euler": (0, 0.5, 0)},
    {"scale": (2000, 2000, 1500)},
    {"location": (0.01, 0, 0), "scale": (1e-3, 1e-3, 1e-3)},
]


def vector(point):
    return Vector([float(value) for value in point])


def strokes():
    return module("bridge.strokes")


def drawing():
    return module("features.layouts.drawing")


def state(obj):
    """Everything of an object that an operator could have changed."""
    mesh = obj.data
    points = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", points)
    return (
        obj.name, mesh.name, points.tobytes(), tuple(map(tuple, obj.matrix_world)), obj.parent, [one.name for one in obj.modifiers], sorted(obj.keys()),
        [one.name for one in obj.users_collection], obj.hide_get(), len(mesh.attributes), len(mesh.materials), obj.is_property_set("hybrid_mesh"),
        obj.is_property_set("hybrid_mesh_layout"),
    )  # fmt: skip


def parented(world, obj):
    """Puts an object under a turned and stretched parent, so that its world matrix shears."""
    parent = bpy.data.objects.new("parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.location, parent.rotation_euler, parent.scale = (1, 2, 3), (0.3, 0.2, 0.9), (1, 2.5, 0.7)
    obj.parent = parent
    bpy.context.view_layer.update()
    return obj


def broken_cube(obj):
    """A cube with one edge that ends half-way."""
    lines = cube_lines(obj)
    return [*lines[:11], lines[11][:5]]


def diagonal(points):
    return numpy.linalg.norm(numpy.ptp(points, axis=0))


def tolerance(world, obj):
    """What single precision may cost where an object stands."""
    points = world.evaluated(obj)[0]
    return 1e-5 * diagonal(points) + 3e-7 * abs(points).max()


def layout_of(obj, kind="DRAWN"):
    return module("features.layouts.properties").layout_of(obj, bpy.context.scene, kind)


def draw(obj, lines):
    """Draw Layout on an object, and strokes into what it makes."""
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.hybrid_mesh.draw_layout() == {"FINISHED"}
    layout = layout_of(obj)
    strokes().write(layout, layout.data.layers.active, bpy.context.scene.frame_current, lines)
    return layout


def check():
    assert bpy.ops.hybrid_mesh.check_layout() == {"FINISHED"}


def read(obj):
    return [stroke.points for stroke in strokes().read(obj, bpy.context.scene.frame_current)]


def distance(world, obj, points):
    """The largest distance of points to the surface of an object, in world space."""
    tree_points, offsets, indices = world.evaluated(obj)
    tree = BVHTree.FromPolygons(tree_points.tolist(), [indices[a:b].tolist() for a, b in zip(offsets[:-1], offsets[1:])])
    return max(tree.find_nearest(point.tolist())[3] for point in points)
