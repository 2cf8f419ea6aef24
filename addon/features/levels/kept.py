# SPDX-License-Identifier: GPL-3.0-or-later
"""Native hierarchies of collections, for as long as Blender runs: work on a level goes on where it stopped, without the remesh."""

import uuid
from dataclasses import dataclass
from typing import Any

MOST = 8  # hierarchies; the maps of a large scan take some ten megabytes
_kept = {}  # token of a collection: Kept, the latest one last


@dataclass
class Kept:
    hierarchy: Any  # never changed: an operation works on a copy, so that undo finds what it was
    source: Any  # meshes.Source of what was remeshed
    settings: Any
    repaired: Any  # what Result.repaired() gave


def keep(collection, kept):
    """Keeps what a collection was made of. The collection's token goes with it through undo, copies and files, of which only the first find it."""
    token = collection.hybrid_mesh.token = uuid.uuid4().hex
    _kept[token] = kept
    while len(_kept) > MOST:
        del _kept[next(iter(_kept))]


def find(collection):
    """What is kept of a collection, or None: it comes of another session, or of long ago."""
    token = collection.hybrid_mesh.token
    kept = _kept.pop(token, None)
    if kept is not None:
        _kept[token] = kept
    return kept


def forget():
    _kept.clear()
