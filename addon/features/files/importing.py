# SPDX-License-Identifier: GPL-3.0-or-later
"""What a .hmesh file has, as objects like those of a remesh."""

import os

import numpy

from ...bridge import arrays, meshes, placement
from ...core import hierarchy_files
from ..levels import hierarchies, kept, stored, streams


def import_file(context, path, most_bytes=0):
    """Makes the objects of a file's hierarchy; returns levels.Built. most_bytes: of a stream, what is read of it at first; 0: all.

    Raises OSError, ValueError and the native errors, each in words for people that need not name the file; then nothing has changed.
    """
    data = hierarchy_files.read(path)
    count = 0
    if hierarchy_files.is_stream(data):
        count = min(most_bytes or len(data), len(data))
        hierarchy, notes = streams.decode_prefix(data, count), hierarchy_files.Notes()
    else:
        hierarchy = hierarchy_files.decode(data)
        notes = hierarchy_files.parse_notes(hierarchy.metadata)
    try:
        matrix, place = placement.by_matrix(notes.matrix, notes.placement)
    except arrays.MatrixError:
        # What it says of its objects is of no use; where its points are is known all the same.
        matrix, place = numpy.eye(4), None
    _check_places(hierarchy, matrix)
    name = os.path.splitext(os.path.basename(path))[0]
    at_hand = kept.Kept(hierarchy, matrix, notes.edited)
    try:
        built = hierarchies.build(context, name, at_hand, hierarchy_files.report(hierarchy, notes.verdict), place=place)
    except meshes.MeshError as error:
        # A stream has no checksum: damaged, it may say that faces lie upon one another.
        raise ValueError("it is damaged: its levels are no meshes") from error
    try:
        built.collection.hybrid_mesh.file = path
        if count:
            streams.attach(built.collection, data, count)
        else:
            # There is no source that could be remeshed when it has gone from memory.
            stored.store(built.collection)
    except BaseException:
        hierarchies.remove(built)
        raise
    return built


def _check_places(hierarchy, matrix):
    for level in hierarchy.level_names:
        with numpy.errstate(over="ignore", invalid="ignore"):
            places = meshes.in_object(hierarchy.level_points(level), matrix)
        if not numpy.isfinite(places).all():
            raise ValueError("it has vertices farther away than Blender's numbers go")
