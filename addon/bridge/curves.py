# SPDX-License-Identifier: GPL-3.0-or-later
"""Curve objects of closed polylines."""

import bpy
import numpy

from .arrays import transformed, world_matrix


def new_object(name, collection):
    """An object of round curves without any, linked to a collection."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    curve.fill_mode = "FULL"
    curve.bevel_resolution = 2
    obj = bpy.data.objects.new(name, curve)
    collection.objects.link(obj)
    return obj


def write_closed(obj, lines, radius):
    """Puts closed polylines in place of all that an object has. lines: ((n, 3) points in world space, thickness, material), thickness as a multiple of `radius`."""
    curve = obj.data
    inverse = numpy.linalg.inv(world_matrix(obj.matrix_world))
    curve.splines.clear()
    curve.materials.clear()
    materials = []
    for points, thickness, material in lines:
        if material not in materials:
            materials.append(material)
            curve.materials.append(material)
        spline = curve.splines.new("POLY")
        spline.points.add(len(points) - 1)
        places = numpy.ones((len(points), 4), dtype=numpy.float32)
        places[:, :3] = transformed(numpy.asarray(points, dtype=float), inverse)
        spline.points.foreach_set("co", places.ravel())
        spline.points.foreach_set("radius", numpy.full(len(points), thickness, dtype=numpy.float32))
        spline.use_cyclic_u = True
        spline.material_index = materials.index(material)
    curve.bevel_depth = radius
    curve.update_tag()
