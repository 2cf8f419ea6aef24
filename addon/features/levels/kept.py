# SPDX-License-Identifier: GPL-3.0-or-later
"""Native hierarchies of collections: work on a level goes on where it stopped, without the remesh. For as long as Blender runs, and in the files that it saves."""

import uuid
from dataclasses import dataclass
from typing import Any

MOST = 8  # hierarchies; the maps of a large scan take some ten megabytes
_kept = {}  # token of a collection: Kept, the latest one last
_read = None  # read(collection) -> Kept or None, of what its file has


@dataclass
class Kept:
    hierarchy: Any  # never changed: an operation works on a copy, so that undo finds what it was
    matrix: Any  # object to world, as the level objects were made
    edited: bool = False  # whether levels were put elsewhere than the surface is
    # Of a hierarchy that was read from a file these are None.
    source: Any = None  # meshes.Source of what was remeshed
    settings: Any = None
    repaired: Any = None  # what Result.repaired() gave


def keep(collection, kept):
    """Keeps what a collection was made of. The collection's token goes with it through undo, copies and files."""
    token = collection.hybrid_mesh.token = uuid.uuid4().hex
    _add(token, kept)


def _add(token, kept):
    _kept[token] = kept
    while len(_kept) > MOST:
        del _kept[next(iter(_kept))]


def find(collection):
    """What is kept of a collection, or None: it comes of a session that did not save it, or of long ago."""
    token = collection.hybrid_mesh.token
    kept = _kept.pop(token, None)
    if kept is None and _read is not None:
        kept = _read(collection)
    if kept is not None:
        _add(token, kept)
    return kept


def at_hand(collection):
    """What is kept of a collection; raises ValueError with a line for people where that is gone."""
    found = find(collection)
    if found is None:
        again = "remesh its source again" if collection.hybrid_mesh.source is not None else "import its file again"
        raise ValueError(f"{collection.name} comes of a session that did not save it, or of long ago: {again}")
    return found


def drop(collection):
    """Forgets what is kept of a collection in memory."""
    _kept.pop(collection.hybrid_mesh.token, None)


def of_token(token):
    """What is kept in memory under a token, or None."""
    return _kept.get(token)


def set_storage(read):
    """Has read(collection) asked for what is not in memory; None: nothing is."""
    global _read
    _read = read


def forget():
    _kept.clear()
