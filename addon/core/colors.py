# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours for figures on a mesh."""

import colorsys

import numpy

# Stretch on a logarithmic scale: 1/4, 1/2, 1 (even), 2, 4 and more. Linear RGB.
STRETCH_STOPS = (-2.0, -1.0, 0.0, 1.0, 2.0)
_COLORS = numpy.array([[0.03, 0.08, 0.45], [0.10, 0.42, 0.75], [0.80, 0.80, 0.78], [0.95, 0.50, 0.08], [0.65, 0.03, 0.03]])


def stretch_colors(stretch):
    """RGBA (n, 4) in float32 of stretch values (n,), where 1 is even sampling: blue below it, grey at it, red above."""
    values = numpy.asarray(stretch, dtype=numpy.float64)
    usable = numpy.isfinite(values) & (values > 0)
    logarithms = numpy.log2(numpy.where(usable, values, 1.0))
    colors = numpy.ones((len(values), 4), dtype=numpy.float32)
    for channel in range(3):
        colors[:, channel] = numpy.interp(logarithms, STRETCH_STOPS, _COLORS[:, channel])
    return colors


# Distances as fractions of the diagonal, on a logarithmic scale: levels of a hierarchy are some ten times apart. Linear RGB.
ERROR_STOPS = (1e-5, 1e-4, 1e-3, 1e-2)
_ERROR_COLORS = numpy.array([[0.80, 0.80, 0.78], [0.10, 0.42, 0.75], [0.95, 0.50, 0.08], [0.65, 0.03, 0.03]])


def error_colors(fractions):
    """RGBA (n, 4) in float32 of distances (n,): grey where there is next to none, then blue, orange, red."""
    logarithms = numpy.log10(numpy.maximum(numpy.asarray(fractions, dtype=numpy.float64), 1e-12))
    colors = numpy.ones((len(logarithms), 4), dtype=numpy.float32)
    for channel in range(3):
        colors[:, channel] = numpy.interp(logarithms, numpy.log10(ERROR_STOPS), _ERROR_COLORS[:, channel])
    return colors


_PATCH_COUNT = 12


def patch_colors(patches):
    """RGBA (n, 4) in float32 of patches' numbers (n,): pale, and hardly ever the same beside one another."""
    palette = numpy.array([(*colorsys.hsv_to_rgb(0.381966 * i % 1, (0.35, 0.5)[i % 2], (0.85, 0.65, 0.75)[i % 3]), 1) for i in range(_PATCH_COUNT)], dtype=numpy.float32)
    # Numbers of neighbours are often alike: a multiplication scatters them.
    return palette[(numpy.asarray(patches, dtype=numpy.int64) * 2654435761 >> 16) % _PATCH_COUNT]


def level_color(level):
    """Linear RGBA of a level above the base, so that neighbours differ; -1 for one that is not known yet, 0 for the base."""
    if level < 0:
        return (0.01, 0.25, 0.9, 1.0)
    if level == 0:
        return (0.25, 0.25, 0.25, 1.0)
    golden = 0.381966
    return (*colorsys.hsv_to_rgb((0.08 + golden * (level - 1)) % 1, 0.95, 0.85), 1.0)
