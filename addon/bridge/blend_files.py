# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh objects out of .blend files and of what Blender imports, and hierarchies into .blend files, for the command line."""

import importlib.util
import os

import addon_utils
import bpy
import numpy

from .. import compat
from ..core.native import native
from . import density as densities
from . import levels, meshes
from .arrays import MatrixError

# By extension the operators that import such files, the best first, and for each the add-on that it comes with, if it is not Blender's own.
IMPORTERS = {
    ".glb": (("import_scene", "gltf", "io_scene_gltf2"),),
    ".gltf": (("import_scene", "gltf", "io_scene_gltf2"),),
    ".fbx": (("wm", "fbx_import", None), ("import_scene", "fbx", "io_scene_fbx")),
}


def extract(path, folder, density=""):
    """Saves every mesh object of a scene's file as arrays (evaluated, world space); returns [{name, arrays} or {name, error}], sorted by name.

    density: name of the vertex group or attribute that is saved with them as the density of quads; empty: none. An object without it has an error.

    Raises ValueError where the file cannot be opened or imported.
    """
    if os.path.splitext(path)[1].lower() in IMPORTERS:
        _import(path)
    else:
        _open(path)
    scene = bpy.context.scene
    shapes = _bone_shapes()
    objects = sorted((obj for obj in bpy.data.objects if obj.type == "MESH" and obj.users_scene and obj not in shapes), key=lambda obj: obj.name)
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
            source = meshes.read_source(obj, graph, density=densities.reader(density))
        except (meshes.SourceError, MatrixError) as error:
            entry["error"] = str(error)
            continue
        entry["arrays"] = os.path.join(folder, f"{len(found)}.npz")
        with open(entry["arrays"], "wb") as file:
            points, offsets, indices = source.mesh
            numpy.savez(file, points=points, offsets=offsets, indices=indices, **({} if source.density is None else {"density": source.density}))
    return found


def _open(path):
    try:
        bpy.ops.wm.open_mainfile(filepath=os.path.abspath(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise ValueError(f"is not a .blend that can be opened ({_words(error)})") from error


def _import(path):
    extension = os.path.splitext(path)[1].lower()
    importer = next(filter(None, (_operator(*names) for names in IMPORTERS[extension])), None)
    if importer is None:
        raise ValueError(f"this Blender has no importer for {extension} files")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    compat.give_numpy_its_old_names()
    try:
        result = importer(filepath=os.path.abspath(path))
    except RuntimeError as error:
        raise ValueError(f"is not a {extension} that can be imported ({_words(error)})") from error
    if "FINISHED" not in result:
        raise ValueError(f"is not a {extension} that can be imported")


def _operator(space, name, addon):
    """An operator, with its add-on enabled, or None where there is none."""
    operators = getattr(bpy.ops, space)
    if name not in dir(operators) and addon and importlib.util.find_spec(addon):
        addon_utils.enable(addon)
    return getattr(operators, name) if name in dir(operators) else None


def _words(error):
    """What an operator says of its error; of one that it did not foresee, without the way to it."""
    lines = [line for line in str(error).splitlines() if line.strip()]
    way = [number for number, line in enumerate(lines) if "Traceback" in line]
    if way:
        return next((line for line in lines[way[-1] + 1 :] if not line.startswith(" ")), "it failed")
    return " ".join(" ".join(lines).removeprefix("Error: ").split())


def _bone_shapes():
    """The objects that are drawn in the place of bones: importers make some, and they are no surface of the scene."""
    return {bone.custom_shape for obj in bpy.data.objects if obj.pose for bone in obj.pose.bones if bone.custom_shape}


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
