# SPDX-License-Identifier: GPL-3.0-or-later
"""Native hierarchies in the .blend: written when that is saved, so that a reopened file goes on."""

import json
import os
import tempfile

import bpy
import numpy

from ...bridge import objects
from ...core.native import expected, native
from . import kept

_KEY = "hybrid_mesh_hierarchy"  # a custom property of the collection: the bytes of an .hmesh file


def register():
    kept.set_storage(_read)
    bpy.app.handlers.save_pre.append(_before_save)


def unregister():
    kept.set_storage(None)
    if _before_save in bpy.app.handlers.save_pre:
        bpy.app.handlers.save_pre.remove(_before_save)


@bpy.app.handlers.persistent
def _before_save(*_):
    for collection in bpy.data.collections:
        # Asked first, because reading a property group that was never set leaves an empty one behind.
        if not objects.is_local(collection) or not collection.is_property_set("hybrid_mesh"):
            continue
        token = collection.hybrid_mesh.token
        at_hand = kept.of_token(token)
        if at_hand is not None and collection.hybrid_mesh.stored != token:
            data = _bytes_of(at_hand)
            if _KEY in collection:
                del collection[_KEY]  # Blender 5.0 writes bytes over others up to the first zero alone.
            collection[_KEY] = data
            collection.hybrid_mesh.stored = token


def _read(collection):
    """What is kept of a collection in its file, or None."""
    data = collection.get(_KEY)
    # What is there may be older than the objects: a file that Blender has saved by itself, or an undo to before it was saved.
    if not isinstance(data, bytes) or collection.hybrid_mesh.stored != collection.hybrid_mesh.token:
        return None
    try:
        hierarchy = _through_file(lambda path: _write(path, data), native().load_hierarchy)
        notes = json.loads(hierarchy.metadata)
        matrix, edited = numpy.array(notes["matrix"], dtype=numpy.float64).reshape(4, 4), bool(notes["edited"])
    except Exception as error:
        if not isinstance(error, (KeyError, OSError)) and not expected(error):
            raise
        return None
    return kept.Kept(hierarchy, matrix, edited)


def _bytes_of(at_hand):
    metadata = json.dumps({"matrix": at_hand.matrix.ravel().tolist(), "edited": at_hand.edited})
    return _through_file(lambda path: at_hand.hierarchy.save(path, metadata), _contents)


def _through_file(write, read):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "hierarchy.hmesh")
        write(path)
        return read(path)


def _write(path, data):
    with open(path, "wb") as file:
        file.write(data)


def _contents(path):
    with open(path, "rb") as file:
        return file.read()
