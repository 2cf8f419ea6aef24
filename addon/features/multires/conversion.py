# SPDX-License-Identifier: GPL-3.0-or-later
"""The regular levels of a hierarchy, those above its last irregular one, as a Multires modifier."""

from dataclasses import dataclass

import bpy
import numpy

from ...bridge import arrays, grids, levels, meshes, multires, transfer
from ..levels import editing, kept, made
from ..levels.properties import level_number

SUFFIX = "_multires"


@dataclass
class Converted:
    obj: bpy.types.Object
    base: str  # names of the levels that the mesh itself and the finest Multires level are
    finest: str
    steps: int
    completed: bool  # whether the hierarchy was adaptive, so that larger quads were subdivided
    error: float  # of the finest level, the largest difference of a coordinate, as a fraction of the bounding box's diagonal

    def line(self):
        """One line for people."""
        text = f"{self.obj.name}: {self.steps} Multires levels on {self.base}, up to {self.finest}"
        if self.completed:
            text += ", quads that are larger on that level having been subdivided"
        return f"{text}; off by at most {self.error:.1e} of the diagonal"


def last_irregular_level(hierarchy):
    """The number of the last level with an irregular operation, which is where handles and the like open, too; 0 without any."""
    return max((hierarchy.operation(number)["level"] for number in range(hierarchy.operation_count)), default=0)


def base_level(hierarchy):
    """The name of the level that the mesh itself is."""
    return f"N{last_irregular_level(hierarchy)}"


def convert(context, collection):
    """Makes a mesh object with Multires of a hierarchy, beside it; returns Converted. Raises ValueError with a line for people, and the native errors; then nothing is left behind."""
    at_hand = kept.at_hand(collection)
    shown = editing.Shown(collection, at_hand)
    edited = shown.edited()
    if edited:
        raise ValueError(f"{', '.join(edited)} was edited and Multires would not have that: update or reset it first")
    hierarchy = at_hand.hierarchy
    first, given = last_irregular_level(hierarchy), level_number(hierarchy.level_names[-1])
    complete = hierarchy.copy()
    complete.complete()
    finest = level_number(complete.level_names[-1])
    if first >= finest:
        why = f"N{first}, the last one, has irregular operations" if first else "there is one level alone"
        raise ValueError(f"{collection.name}: {why}: no regular level is left above it for Multires")
    base, fine = complete.level(f"N{first}"), complete.level(f"N{finest}")
    obj = _base_object(context, collection, shown, f"N{first}", base, at_hand.matrix)
    try:
        over = grids.level_grids(base, fine, finest - first)
        if arrays.mirrors(at_hand.matrix):
            over = grids.turned_over(over)
        places = meshes.in_object(fine["points"], at_hand.matrix)
        off = multires.add_multires(context, obj, over, places, finest - first)
    except BaseException:
        made.remove(obj)
        raise
    diagonal = float(numpy.linalg.norm(numpy.ptp(places, axis=0)))
    is_adaptive = finest > given or len(complete.level_points(f"N{finest}")) > len(hierarchy.level_points(f"N{given}"))
    return Converted(obj, f"N{first}", f"N{finest}", finest - first, is_adaptive, off / diagonal if diagonal > 0 else 0.0)


def _base_object(context, collection, shown, name, base, matrix):
    """An object of a level whole and regular: that of the level with all that it carries, or where larger quads are in it, one that has been completed."""
    level = made.level_object(collection, name)
    if level is None:
        raise ValueError(f"{collection.name}: the object of {name} is gone")
    mesh, expected = meshes.mesh_arrays(level.data), numpy.asarray(base["indices"])[meshes.corner_order(numpy.asarray(base["offsets"]), matrix)]
    if numpy.array_equal(mesh.indices, expected):
        return made.make_object(context, collection, level.data.copy(), SUFFIX, name)
    if len(base["points"]) == len(level.data.vertices):
        raise ValueError(f"{level.name} has other faces than its level: reset or remesh it")
    source = meshes.read_mesh(level, matrix, transfer.collect)
    mesh = meshes.new_mesh(level.data.name, base, matrix)
    levels.add_figures(mesh, base)
    for material in level.data.materials:
        mesh.materials.append(material)
    obj = made.make_object(context, collection, mesh, SUFFIX, name)
    transfer.Carrier(source)(obj, base)
    return obj
