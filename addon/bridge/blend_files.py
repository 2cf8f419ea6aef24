# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh objects out of .blend files and hierarchies into them, for the command line."""

import os

import bpy
import numpy

from ..core.native import explain, native
from . import levels, meshes
from .arrays import MatrixError


def extract(path, folder):
    """Saves every mesh object of a .blend as arrays (evaluated, world space); returns [{name, arrays} or {name, error}], sorted by name."""
    try:
        bpy.ops.wm.open_mainfile(filepath=os.path.abspath(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise ValueError(f"is not a .blend that can be opened ({explain(ValueError(error))})") from error
    scene = bpy.context.scene
    objects = sorted((obj for obj in bpy.data.objects if obj.type == "MESH" and obj.users_scene), key=lambda obj: obj.name)
    for obj in objects:
        # Hidden or in another scene, it is an input all the same; only what the dependency graph sees has its modifiers applied.
        if scene.collection.objects.get(obj.name) is not obj:
            scene.collection.objects.link(obj)
        obj.hide_viewport = False
    graph = bpy.context.evaluated_depsgraph_get()
    found = []
    for obj in objects:
        entry = {"name": obj.name}
        found.append(entry)
        try:
            points, offsets, indices = meshes.read_source(obj, graph).mesh
        except (meshes.SourceError, MatrixError) as error:
            entry["error"] = str(error)
            continue
        entry["arrays"] = os.path.join(folder, f"{len(found)}.npz")
        with open(entry["arrays"], "wb") as file:
            numpy.savez(file, points=points, offsets=offsets, indices=indices)
    return found


def new():
    """Starts an empty file in a Blender that knows of no add-on."""
    bpy.ops.wm.read_factory_settings(use_empty=True)


def build(hmesh, name):
    """Puts the levels of a .hmesh into the scene; returns levels.Built."""
    hierarchy = native().load_hierarchy(hmesh)
    parts = [(level, hierarchy.level(level)) for level in hierarchy.level_names]
    built = levels.build(name, parts, numpy.eye(4), bpy.context.scene)
    levels.show_preview_only(built)
    return built


def save(target):
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(target), compress=True, copy=True)
    if not os.path.isfile(target):
        raise OSError("the .blend could not be written")
