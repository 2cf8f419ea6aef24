# SPDX-License-Identifier: GPL-3.0-or-later
"""Hierarchies of the scene as .hmesh files."""

import json
import os
import tempfile

import numpy

from ...bridge import arrays
from ...bridge.names import readable
from ...core import hierarchy_files
from ...core.process import ProcessJob
from ...core.tasks import Task
from ...core.version import VERSION
from ..levels import editing, kept
from ..levels import properties as hierarchy_properties

_STANDS = 1e-6  # of a matrix's size: what is farther off has been moved


def save_container(collection, path):
    """Writes a hierarchy with its maps, and where its objects stand. Raises ValueError and the native errors."""
    at_hand = kept.at_hand(collection)
    at_hand.hierarchy.save(path, json.dumps(_metadata(collection, at_hand)))


def stream_task(collection, path, most_bytes=0, error=0.0, exact=False):
    """A task that writes a hierarchy as a stream, where its objects stand in the world now. The settings are the native save_stream()'s.

    It works in a process of its own, since save_stream() cannot be cancelled from here. Raises ValueError.
    """
    at_hand = kept.at_hand(collection)
    motion = _placement(collection, at_hand.matrix) @ numpy.linalg.inv(at_hand.matrix)
    hierarchy = at_hand.hierarchy
    if not _same(motion, numpy.eye(4)):
        if arrays.mirrors(motion):
            raise ValueError(f"{collection.name} was mirrored since it was made, and a stream cannot turn faces over: write a container")
        hierarchy = _moved(hierarchy, motion)
    job = {"kind": "encode", "output": path, "bytes": most_bytes, "error": error, "exact": exact, "source": ""}

    def start():
        folder = tempfile.TemporaryDirectory()
        given = os.path.join(folder.name, "given" + hierarchy_files.EXTENSION)
        hierarchy.save(given)
        return ProcessJob({**job, "path": given}, "encoding", folder.cleanup)

    return Task(readable(os.path.basename(path)), start)


def not_carried(collection):
    """The names of level objects that were edited since the levels were last updated: files do not have that."""
    try:
        for obj in collection.objects:
            obj.update_from_editmode()
        return editing.Shown(collection, kept.at_hand(collection)).edited()
    except ValueError:
        return []  # What cannot be carried to the other levels is not theirs.


def _metadata(collection, at_hand):
    """As the command line writes it, and where the objects are: hierarchy_files.Notes."""
    report = hierarchy_properties.report_of(collection)
    placement = _placement(collection, at_hand.matrix)
    return {
        "name": hierarchy_properties.name_of(collection),
        "settings": report.get("settings"),
        "version": VERSION,
        "verdict": None if at_hand.edited else report.get("verdict"),
        "matrix": at_hand.matrix.ravel().tolist(),
        "placement": placement.ravel().tolist(),
        "edited": at_hand.edited,
    }


def _placement(collection, matrix):
    """Where the objects of a hierarchy stand now: the matrix from their space to the world."""
    preview = collection.hybrid_mesh.preview
    if preview is None:
        return matrix
    placement = arrays.world_matrix(preview.matrix_world)
    return matrix if _same(placement, matrix) else placement


def _same(a, b):
    return numpy.abs(a - b).max() <= _STANDS * numpy.abs(b).max()


def _moved(hierarchy, motion):
    """A copy with all levels moved. A level that is set after coarser ones is exactly where it is put, however their motion has carried it."""
    moved = hierarchy.copy()
    for level in hierarchy.level_names:
        moved.set_level(level, arrays.transformed(hierarchy.level_points(level), motion))
    return moved
