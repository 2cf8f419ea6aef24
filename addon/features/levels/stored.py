# SPDX-License-Identifier: GPL-3.0-or-later
"""Native hierarchies in the .blend: written when that is saved, so that a reopened file goes on."""

import bpy
import numpy

from ...bridge import objects
from ...core import hierarchy_files
from ...core.native import expected
from . import kept, streams

_KEY = "hybrid_mesh_hierarchy"  # a custom property of the collection: the bytes of an .hmesh file


def register():
    kept.set_storage(_read)
    bpy.app.handlers.save_pre.append(_before_save)


def unregister():
    kept.set_storage(None)
    if _before_save in bpy.app.handlers.save_pre:
        bpy.app.handlers.save_pre.remove(_before_save)


def store(collection):
    """Writes what is kept of a collection into it, if that is in memory and not there yet: from then on it is found wherever the collection is."""
    token = collection.hybrid_mesh.token
    at_hand = kept.of_token(token)
    if at_hand is None or collection.hybrid_mesh.stored == token or streams.is_shown(collection):
        return
    metadata = {"matrix": at_hand.matrix.ravel().tolist(), "edited": at_hand.edited}
    data = hierarchy_files.encode(at_hand.hierarchy, metadata)
    if _KEY in collection:
        del collection[_KEY]  # Blender 5.0 writes bytes over others up to the first zero alone.
    collection[_KEY] = data
    collection.hybrid_mesh.stored = token


@bpy.app.handlers.persistent
def _before_save(*_):
    for collection in bpy.data.collections:
        # Asked first, because reading a property group that was never set leaves an empty one behind.
        if objects.is_local(collection) and collection.is_property_set("hybrid_mesh"):
            store(collection)


def _read(collection):
    """What is kept of a collection in its file, or None."""
    if streams.is_shown(collection):
        return streams.read(collection)
    data = collection.get(_KEY)
    # What is there may be older than the objects: a file that Blender has saved by itself, or an undo to before it was saved.
    if not isinstance(data, bytes) or collection.hybrid_mesh.stored != collection.hybrid_mesh.token:
        return None
    try:
        hierarchy = hierarchy_files.decode(data)
    except Exception as error:
        if not isinstance(error, OSError) and not expected(error):
            raise
        return None
    notes = hierarchy_files.parse_notes(hierarchy.metadata)
    return kept.Kept(hierarchy, numpy.reshape(notes.matrix, (4, 4)).astype(numpy.float64), notes.edited)
