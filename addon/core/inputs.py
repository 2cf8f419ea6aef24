# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of a batch: what each is called, which files it makes, and what is refused before anything starts."""

import collections
import itertools
import os
from dataclasses import dataclass, field

from .limits import limits
from .native import explain

MESH_EXTENSIONS = (".ply", ".obj", ".off", ".stl")
SCENE_EXTENSIONS = (".blend", ".glb", ".gltf", ".fbx")  # which Blender opens or imports; each mesh object of one is an input
MESH_FORMATS = ("ply", "obj")  # that the native module writes
EXPORT_FORMATS = (*MESH_FORMATS, "glb")
MOST_NAMED = 5  # of what is skipped in a folder


class InputsError(ValueError):
    """A set of inputs that cannot be done together; nothing has been started."""


@dataclass
class Input:
    path: str  # as the user gave it
    name: str  # of the outputs
    object_name: str = ""  # of a scene's mesh object
    arrays: str = ""  # file with the object's mesh
    error: str = ""  # why it cannot be read, if that is known before it starts
    shown: str = ""  # what people know the path as, if not as `path`

    @property
    def label(self):
        path = self.shown or self.path
        return f"{path}: {self.object_name}" if self.object_name else path


@dataclass
class Outputs:
    """What each input makes besides NAME.hmesh and NAME.report.json."""

    exports: tuple = ()
    repaired: bool = False
    blend: bool = False
    levels: tuple = ()  # formats in which every level is written
    report: str = field(default=".report.json", init=False)

    def suffixes(self):
        """The report is last: where it stands, everything stands."""
        suffixes = [".hmesh", ".plan.json"]
        suffixes += [f".{form}" for form in self.exports]
        if self.repaired:
            suffixes += [f".repaired.{form}" for form in self.exports or ("ply",)]
        if self.blend:
            suffixes.append(".blend")
        return [*suffixes, self.report]

    def level_suffixes(self, count):
        """Of the levels' files, with so many levels: a file for each, but of .glb one for all."""
        suffixes = [f".N{level}.{form}" for level in range(count) for form in self.levels if form != "glb"]
        return [*suffixes, ".levels.glb"] if "glb" in self.levels else suffixes


def is_scene(path):
    return _extension(path) in SCENE_EXTENSIONS


def needs_blender(path):
    """Why a scene cannot be read here, for where there is no Blender."""
    return f"a {_extension(path)} can be read inside Blender only; this is Python without Blender"


def expand(paths, output, tell):
    """An Input for each file that paths of files and folders name, in their order, and each once; a folder stands for the meshes and scenes directly in it, by name.

    What cannot be read has its error. tell(line) is told what else a folder holds; hidden entries and the folder of the outputs are not spoken of.
    """
    items = {}
    for path in paths:
        for item in _in_folder(path, output, tell) if os.path.isdir(path) else [file_input(path)]:
            items.setdefault(_place(item.path), item)
    return list(items.values())


def _in_folder(folder, output, tell):
    try:
        names = sorted(name for name in os.listdir(folder) if not name.startswith("."))
    except OSError as error:
        return [failed_input(folder, explain(error, folder))]
    found, others = [], []
    for name in names:
        path = os.path.join(folder, name)
        if os.path.isdir(path):
            if _identity(path) != _identity(output):
                others.append(name + "/")
        elif _extension(path) in MESH_EXTENSIONS + SCENE_EXTENSIONS:
            found.append(file_input(path))
        else:
            others.append(name)
    if others:
        more = f" and {len(others) - MOST_NAMED} more" if len(others) > MOST_NAMED else ""
        tell(f"{folder}: skipped, no mesh files: {', '.join(others[:MOST_NAMED])}{more}")
    return found or [failed_input(folder, "is a folder without a mesh file")]


def file_input(path):
    """The Input for a mesh or a scene, with its error set where one glance shows that it cannot be read."""
    if _extension(path) in MESH_EXTENSIONS + SCENE_EXTENSIONS:
        return Input(path, _stem(path))
    return failed_input(path, f"is not a kind of file that can be read ({', '.join(MESH_EXTENSIONS)}, and in Blender {', '.join(SCENE_EXTENSIONS)})")


def failed_input(path, error):
    return Input(path, _stem(path), error=error)


def object_input(path, object_name, arrays):
    return Input(path, file_name(object_name), object_name, arrays)


def file_name(name):
    """An object's name as the name of a file: the few characters that no file system takes are replaced."""
    name = "".join("_" if character in '/\\:*?"<>|' or ord(character) < 32 else character for character in name)
    return "_" + name[1:] if name.startswith(".") else name or "_"


def name_apart(items, outputs, folder):
    """Has no two inputs write one file: where they would, they are called NAME, NAME-2, NAME-3, ... in the order of their paths and of the objects in a file, in
    whatever order they were given. Returns those that got another name. Raises InputsError where an output would overwrite an input.
    """
    most_levels = limits().most_levels if outputs.levels else 0
    suffixes = (*outputs.suffixes(), *outputs.level_suffixes(most_levels + 1))
    written = set()

    def take(name):
        files = {os.path.normcase(name + suffix) for suffix in suffixes}
        free = written.isdisjoint(files)
        if free:
            written.update(files)
        return free

    ordered = sorted(items, key=lambda item: (_place(item.path), item.object_name))
    # A name that only one has is never given to another.
    renamed = [item for item in ordered if not take(item.name)]
    numbers = collections.defaultdict(lambda: itertools.count(2))
    for item in renamed:
        item.name = next(name for name in (f"{item.name}-{number}" for number in numbers[item.name]) if take(name))
    sources = {_identity(item.path) for item in items}
    for item in items:
        for suffix in suffixes:
            target = os.path.join(folder, item.name + suffix)
            if _identity(target) in sources:
                raise InputsError(f"{target} is an input and would be overwritten; give another folder with --output")
    return renamed


def _stem(path):
    # Of a folder the path may end in a slash, or be a dot.
    return os.path.splitext(os.path.basename(os.path.abspath(path)))[0] or "_"


def _extension(path):
    return os.path.splitext(path)[1].lower()


def _place(path):
    """What a path names, whatever it is written like; links are files of their own."""
    return os.path.normcase(os.path.abspath(path))


def _identity(path):
    return os.path.normcase(os.path.realpath(path))
