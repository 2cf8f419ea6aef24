# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of a batch: what each is called, which files it makes, and what is refused before anything starts."""

import os
from dataclasses import dataclass, field

from .limits import limits

MESH_EXTENSIONS = (".ply", ".obj", ".off", ".stl")
EXPORT_FORMATS = ("ply", "obj")


class InputsError(ValueError):
    """A set of inputs that cannot be done together; nothing has been started."""


@dataclass
class Input:
    path: str  # as the user gave it
    name: str  # of the outputs
    object_name: str = ""  # of a .blend's mesh object
    arrays: str = ""  # file with the object's mesh
    error: str = ""  # why it cannot be read, if that is known before it starts

    @property
    def label(self):
        return f"{self.path}: {self.object_name}" if self.object_name else self.path


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
        """Of the levels' files, with so many levels."""
        return [f".N{level}.{form}" for level in range(count) for form in self.levels]


def is_blend(path):
    return os.path.splitext(path)[1].lower() == ".blend"


def file_input(path):
    """The Input for a mesh file, with its error set where one glance shows that it cannot be read."""
    stem, extension = os.path.splitext(os.path.basename(path))
    item = Input(path, stem)
    if os.path.isdir(path):
        item.error = "is a folder, not a mesh file"
    elif extension.lower() not in MESH_EXTENSIONS:
        item.error = f"is not a kind of file that can be read ({', '.join(MESH_EXTENSIONS)}, and .blend in Blender)"
    return item


def object_input(path, object_name, arrays):
    return Input(path, file_name(object_name), object_name, arrays)


def file_name(name):
    """An object's name as the name of a file: the few characters that no file system takes are replaced."""
    name = "".join("_" if character in '/\\:*?"<>|' or ord(character) < 32 else character for character in name)
    return "_" + name[1:] if name.startswith(".") else name or "_"


def refuse_clashes(items, outputs, folder):
    """Raises InputsError where two inputs would write one file, or one would overwrite an input."""
    sources = {_identity(item.path): item.path for item in items}
    most_levels = limits().most_levels if outputs.levels else 0
    made = {}
    for item in items:
        for suffix in (*outputs.suffixes(), *outputs.level_suffixes(most_levels + 1)):
            target = os.path.join(folder, item.name + suffix)
            key = os.path.normcase(target)
            if key in made:
                other = made[key]
                raise InputsError(
                    f"two inputs of one name: {other.label} and {item.label} would both write {item.name}{suffix}; rename one or give them folders of their own"
                )
            made[key] = item
            if _identity(target) in sources:
                raise InputsError(f"{target} is an input and would be overwritten; give another folder with --output")


def _identity(path):
    return os.path.normcase(os.path.realpath(path))
