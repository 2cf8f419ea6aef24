# SPDX-License-Identifier: GPL-3.0-or-later
"""Hybrid mesh files, written and read by the operators."""

import os

import bpy
from conftest import module
from test_level_editing import by_name


def import_hmesh(world, path, **settings):
    """(collection, levels by name, preview) of one file."""
    assert bpy.ops.hybrid_mesh.import_hmesh(filepath=str(path), **settings) == {"FINISHED"}
    collection, levels, preview = world.hierarchy(bpy.context.object)
    assert bpy.context.object == preview and bpy.context.selected_objects == [preview]
    return collection, by_name(levels), preview


def export_hmesh(world, obj, path, **settings):
    world.select(obj)
    assert bpy.ops.hybrid_mesh.export_hmesh(filepath=str(path), **settings) == {"FINISHED"}
    return os.path.getsize(path)


def native_of(collection):
    return module("features.levels.kept").at_hand(collection).hierarchy


def clear():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    module("features.levels.kept").forget()


def scene_contents():
    """Everything that an import might leave behind."""
    kinds = ("objects", "meshes", "collections", "node_groups", "texts", "materials")
    return {kind: sorted(block.name for block in getattr(bpy.data, kind)) for kind in kinds}


def written_stream(world, folder):
    """A whole stream, its size, and the final mesh that was encoded; the scene is empty."""
    collection, _, preview = world.remesh(world.scan())
    path = folder / "small.hmesh"
    size = export_hmesh(world, preview, path, kind="STREAM", exact=True)
    final = native_of(collection).final_mesh()
    clear()
    return path, size, final
