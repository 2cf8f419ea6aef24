# SPDX-License-Identifier: GPL-3.0-or-later
"""The density of quads as an object has it: a vertex group, or an attribute of its points, corners or faces."""

import functools

import numpy

from . import meshes

_COLORS = {"FLOAT_COLOR", "BYTE_COLOR"}
_KINDS = {"FLOAT", "INT", "BOOLEAN"} | _COLORS
_DOMAINS = {"POINT", "CORNER", "FACE"}
OUTSIDE = 0.5  # of vertices that are not in the group: quads are there as they would be without
_BRIGHTNESS = numpy.array([0.2126, 0.7152, 0.0722])


def reader(name):
    """What meshes.read_source() is to read the density by; None for no name."""
    return functools.partial(density_at_vertices, name=name) if name else None


def names_of(obj):
    """What can be a density of a mesh object."""
    groups = [group.name for group in obj.vertex_groups]
    found = [attribute.name for attribute in obj.data.attributes if _can_be_read(attribute) and not attribute.name.startswith(".")]
    return groups + [name for name in found if name not in groups]


def density_at_vertices(obj, mesh, name):
    """The values of a vertex group or an attribute at the vertices of an object's evaluated mesh, as float64; of corners and faces the mean of those around a vertex, of a
    colour its brightness as the colour picker shows it. Raises SourceError with the name."""
    group = obj.vertex_groups.get(name)
    if group is not None:
        return _group_weights(mesh, group.index)
    attribute = mesh.attributes.get(name)
    if attribute is None:
        raise meshes.SourceError(f"it has no vertex group and no attribute {name!r} for the density")
    if not _can_be_read(attribute):
        raise meshes.SourceError(
            f"its attribute {name!r} cannot be the density: it is {attribute.data_type} of {attribute.domain}, not a number or a colour of points, corners or faces"
        )
    values = _values_of(attribute)
    if not numpy.isfinite(values).all():
        raise meshes.SourceError(f"its attribute {name!r}, the density, is not a finite number everywhere")
    if attribute.domain == "POINT":
        return values
    corners = meshes.values_of(mesh.loops, "vertex_index", 1, numpy.int32)
    if attribute.domain == "FACE":
        order = numpy.empty(len(corners), dtype=numpy.int64)  # the face of each corner
        starts, totals = (meshes.values_of(mesh.polygons, field, 1, numpy.int32) for field in ("loop_start", "loop_total"))
        offsets = numpy.cumsum(totals) - totals
        order[numpy.repeat(starts - offsets, totals) + numpy.arange(totals.sum())] = numpy.repeat(numpy.arange(len(totals)), totals)
        values = values[order]
    count = numpy.bincount(corners, minlength=len(mesh.vertices))
    sums = numpy.bincount(corners, values, minlength=len(mesh.vertices))
    return numpy.where(count > 0, sums / numpy.maximum(count, 1), OUTSIDE)


def _can_be_read(attribute):
    return attribute.data_type in _KINDS and attribute.domain in _DOMAINS


def _values_of(attribute):
    if attribute.data_type in _COLORS:
        return meshes.values_of(attribute.data, "color_srgb", 4)[:, :3].astype(numpy.float64) @ _BRIGHTNESS
    return meshes.values_of(attribute.data, "value", 1, bool if attribute.data_type == "BOOLEAN" else numpy.int32 if attribute.data_type == "INT" else numpy.float32).astype(numpy.float64)


def _group_weights(mesh, index):
    weights = numpy.full(len(mesh.vertices), OUTSIDE)
    for vertex in mesh.vertices:
        for element in vertex.groups:
            if element.group == index:
                weights[vertex.index] = element.weight
    return weights
