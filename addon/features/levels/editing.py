# SPDX-License-Identifier: GPL-3.0-or-later
"""Levels whose objects were edited: the others follow, or it is taken back."""

from dataclasses import replace

import numpy

from ...bridge import meshes, objects
from . import kept
from .properties import is_level


def update(level, coarser):
    """Carries what was edited of a level's object to the other levels: the finer ones, and the coarser ones if asked. Returns how many objects have changed.

    Raises ValueError with a line for people, and the native errors; then nothing has changed.
    """
    collection = level.hybrid_mesh.hierarchy
    at_hand = kept.at_hand(collection)
    shown = Shown(collection, at_hand, level)
    points = shown.edited_points(level)
    if points is None:
        raise ValueError(f"{level.name} is as it was: there is nothing to carry to the other levels")
    pending = shown.edited(but=level)
    if pending:
        raise ValueError(f"{', '.join(pending)} was edited, too, and would lose that: update or reset it first")
    hierarchy = at_hand.hierarchy.copy()
    hierarchy.set_level(level.hybrid_mesh.level, points, coarser=coarser)
    # The level itself, too: on the way to world space and back its places may be rounded.
    changed = [obj for obj in shown.objects if shown.show(obj, hierarchy) and obj != level]
    kept.keep(collection, replace(at_hand, hierarchy=hierarchy, edited=True))
    return len(changed)


def reset(level):
    """Takes back what was edited of a level's object since the levels were last updated. Returns whether there was anything. Raises ValueError."""
    collection = level.hybrid_mesh.hierarchy
    at_hand = kept.at_hand(collection)
    return Shown(collection, at_hand, level).show(level, at_hand.hierarchy)


class Shown:
    """The level objects of a hierarchy beside the native one that they show, as it was before. Raises ValueError where one cannot be changed.

    level: the one that is meant where there are several objects of a level.
    """

    def __init__(self, collection, at_hand, level=None):
        self._hierarchy, self._matrix = at_hand.hierarchy, at_hand.matrix
        self._points = {}
        names = at_hand.hierarchy.level_names
        by_level = {}
        # A copy of a level's object is none, unless it is the one that is meant.
        for obj in (level, *collection.objects):
            if is_level(obj) and obj.hybrid_mesh.hierarchy == collection and obj.type == "MESH":
                by_level.setdefault(obj.hybrid_mesh.level, obj)
        self.objects = [by_level[name] for name in names if name in by_level]
        for obj in self.objects:
            self._check(obj)

    def _check(self, obj):
        if not objects.is_local(obj) or not objects.is_local(obj.data):
            raise ValueError(f"{obj.name} comes of a library and cannot be changed")
        if obj.data.shape_keys is not None:
            raise ValueError(f"{obj.name} has shape keys: apply or remove them first")
        name, count = obj.hybrid_mesh.level, len(obj.data.vertices)
        if count != len(self._of(name)):
            raise ValueError(f"{obj.name} has {count:,} vertices, its level has {len(self._of(name)):,}: a level keeps its vertices, only their places can be edited")

    def _of(self, name):
        if name not in self._points:
            self._points[name] = self._hierarchy.level_points(name)
        return self._points[name]

    def edited_points(self, obj):
        """The points of an object in world space, those that nobody has touched being exactly the hierarchy's; None where that is all of them."""
        own = self._of(obj.hybrid_mesh.level)
        places = meshes.values_of(obj.data.vertices, "co", 3)
        if not numpy.isfinite(places).all():
            raise ValueError(f"{obj.name} has vertices at places that are not finite")
        touched = (places != meshes.in_object(own, self._matrix)).any(axis=1)
        if not touched.any():
            return None
        return numpy.where(touched[:, None], meshes.in_world(places, self._matrix), own)

    def edited(self, but=None):
        """The names of the objects that were edited since."""
        return [obj.name for obj in self.objects if obj != but and self.edited_points(obj) is not None]

    def show(self, obj, hierarchy):
        """Puts an object's vertices where a hierarchy has them. Returns whether any has moved."""
        return meshes.set_places(obj.data, meshes.in_object(hierarchy.level_points(obj.hybrid_mesh.level), self._matrix))
