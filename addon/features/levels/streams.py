# SPDX-License-Identifier: GPL-3.0-or-later
"""Hierarchies that were imported from a stream: all of it stays with the collection, and levels show as many of its first bytes as are asked for."""

import bpy
import numpy
from bpy.props import IntProperty, StringProperty

from ...bridge import objects
from ...core import hierarchy_files
from ...core.native import expected, explain, native
from . import editing, kept

_KEY = "hybrid_mesh_stream_bytes"  # a custom property of the collection
_MOST = 2**31 - 1  # Blender's whole numbers have 32 bits


class HybridMeshStream(bpy.types.PropertyGroup):
    bytes: IntProperty(
        name="Bytes", description="How many of the stream's first bytes the levels show, at least those that have the base", min=1, max=_MOST,
        soft_max=1_000_000, get=lambda self: self.shown, set=lambda self, value: _show_or_say(self.id_data, value), options=set(),
    )  # fmt: skip
    shown: IntProperty(name="Shown", description="How many bytes the levels show", options={"HIDDEN"})
    least: IntProperty(name="Least", description="How many bytes the base takes; 1 where that is not known", default=1, options={"HIDDEN"})
    size: IntProperty(name="Size", description="How many bytes there are", options={"HIDDEN"})
    token: StringProperty(name="Token", description="The token of the native hierarchy that these bytes are", options={"HIDDEN"})


class TooFewBytes(ValueError):
    """They do not have the base whole, which takes `least`."""

    def __init__(self, count, least):
        super().__init__(f"{count:,} bytes are too few: the base alone takes {least:,}")
        self.least = least


def decode_prefix(data, count):
    """The native hierarchy of the first bytes of a stream. Raises TooFewBytes with a line for people, and the native errors."""
    try:
        return hierarchy_files.decode(data[:count])
    except native().CorruptStream:
        if count >= len(data):
            raise
        least = hierarchy_files.least_prefix(data)
        if least <= count:
            raise
        raise TooFewBytes(count, least) from None


def attach(collection, data, count):
    """Has a collection whose kept hierarchy is that of the first bytes of a stream know so. The stream stays with it from then on."""
    collection[_KEY] = data
    stream = collection.hybrid_mesh_stream
    stream.size, stream.shown, stream.token = len(data), count, collection.hybrid_mesh.token


def has_stream(collection):
    # Asked first, because reading a property group that was never set leaves an empty one behind.
    return collection.is_property_set("hybrid_mesh_stream") and bool(collection.hybrid_mesh_stream.token)


def is_shown(collection):
    """Whether a collection's levels are what its stream says; not where they were edited since."""
    return has_stream(collection) and collection.hybrid_mesh_stream.token == collection.hybrid_mesh.token


def read(collection):
    """What is kept of a collection whose stream is shown, or None."""
    data = collection.get(_KEY)
    if not isinstance(data, bytes):
        return None
    try:
        return kept.Kept(hierarchy_files.decode(data[: collection.hybrid_mesh_stream.shown]), numpy.eye(4))
    except Exception as error:
        if not isinstance(error, OSError) and not expected(error):
            raise
        return None


def show(collection, count):
    """Has the levels show so many of the stream's first bytes, or as many as there are, or as the base takes.

    Raises ValueError with a line for people, and the native errors.
    """
    if not is_shown(collection):
        raise ValueError(f"{collection.name}: its levels were edited, and another part of the stream would take that back")
    if not objects.is_local(collection):
        raise ValueError(f"{collection.name} comes of a library and cannot be changed")
    at_hand = kept.at_hand(collection)
    shown = editing.Shown(collection, at_hand)
    edited = shown.edited()
    if edited:
        raise ValueError(f"{', '.join(edited)} was edited and would lose that: update or reset it first")
    data, stream = collection[_KEY], collection.hybrid_mesh_stream
    count = min(max(count, stream.least), len(data))
    try:
        hierarchy = decode_prefix(data, count)
    except TooFewBytes as error:
        count = stream.least = error.least  # Found out once: it takes many attempts.
        hierarchy = decode_prefix(data, count)
    for obj in shown.objects:
        shown.show(obj, hierarchy)
    # What was shown before can be decoded again: it need not push other hierarchies out of memory.
    kept.drop(collection)
    kept.keep(collection, kept.Kept(hierarchy, at_hand.matrix))
    stream.shown, stream.token = count, collection.hybrid_mesh.token


def _show_or_say(collection, count):
    """A property that cannot be set keeps its value; a line beside the pointer says why."""
    try:
        show(collection, count)
    except Exception as error:
        if not expected(error):
            raise
        line = explain(error)
        if not bpy.app.background:
            bpy.context.window_manager.popup_menu(lambda menu, context: menu.layout.label(text=line), title="Bytes", icon="ERROR")


PROPERTIES = ((bpy.types.Collection, "hybrid_mesh_stream", HybridMeshStream),)
