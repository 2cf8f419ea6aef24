# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender (or under the bpy module) with the add-on installed from its zip; HYBRID_MESH_PACKAGE names it."""

import importlib
import os

import bpy
import numpy
import pytest

PACKAGE = os.environ.get("HYBRID_MESH_PACKAGE", "hybrid_mesh")


def module(name):
    """A module of the installed package, e.g. module("bridge.levels")."""
    return importlib.import_module(f"{PACKAGE}.{name}" if name else PACKAGE)


@pytest.fixture(autouse=True)
def empty_scene():
    """Every test starts from an empty file; preferences, and so the add-on, stay."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    yield


class World:
    """Makes objects and measures results."""

    def native(self):
        return module("_native")

    def scan(self, name="scan", subdivisions=4, **transform):
        """A lumpy closed surface of triangles, selected and active."""
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, radius=1)
        obj = bpy.context.object
        obj.name = obj.data.name = name
        for vertex in obj.data.vertices:
            x, y, z = vertex.co
            vertex.co *= 1 + 0.25 * numpy.sin(3 * x) * numpy.cos(2 * y + 1) + 0.1 * numpy.sin(5 * z)
        return self.placed(obj, **transform)

    def box(self, name="box", **transform):
        """Six quads."""
        bpy.ops.mesh.primitive_cube_add(size=2)
        bpy.context.object.name = name
        return self.placed(bpy.context.object, **transform)

    def placed(self, obj, **transform):
        for key, value in transform.items():
            setattr(obj, key, value)
        self.select(obj)
        bpy.context.view_layer.update()
        return obj

    def select(self, *objects):
        bpy.context.view_layer.update()
        for obj in bpy.context.view_layer.objects:
            obj.select_set(obj in objects)
        bpy.context.view_layer.objects.active = objects[-1] if objects else None

    def evaluated(self, obj):
        """Points, offsets and indices of the evaluated mesh in world space, corners as they stand."""
        meshes, arrays = module("bridge.meshes"), module("bridge.arrays")
        graph = bpy.context.evaluated_depsgraph_get()
        one = obj.evaluated_get(graph)
        points, offsets, indices = meshes.mesh_arrays(one.to_mesh())
        one.to_mesh_clear()
        return arrays.transformed(points, numpy.array(obj.matrix_world, dtype=float)), offsets, indices

    def distance(self, a, b):
        return self.native().compare(*self.evaluated(a), *self.evaluated(b), 20000)

    def volume(self, mesh):
        """Signed volume by the divergence theorem."""
        points, offsets, indices = mesh
        total = 0.0
        for begin, end in zip(offsets[:-1], offsets[1:]):
            corners = points[indices[begin:end]]
            for second, third in zip(corners[1:-1], corners[2:]):
                total += numpy.dot(corners[0], numpy.cross(second, third)) / 6
        return total

    def hierarchy(self, obj):
        """(collection, level objects from coarse to fine, preview) made of an object."""
        properties = module("features.levels.properties")
        collection = properties.hierarchy_of(obj)
        levels = [one for one in collection.objects if one.hybrid_mesh.role == "LEVEL"]
        return collection, sorted(levels, key=lambda one: len(one.data.polygons)), collection.hybrid_mesh.preview

    def remesh(self, obj, **settings):
        self.select(obj)
        assert bpy.ops.hybrid_mesh.remesh(**{"vertices": 3000, **settings}) == {"FINISHED"}
        return self.hierarchy(obj)


@pytest.fixture
def world():
    return World()
