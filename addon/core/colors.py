# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours for figures on a mesh."""

import numpy

# Stretch on a logarithmic scale: 1/4, 1/2, 1 (even), 2, 4 and more. Linear RGB.
_STOPS = numpy.array([-2.0, -1.0, 0.0, 1.0, 2.0])
_COLORS = numpy.array([[0.03, 0.08, 0.45], [0.10, 0.42, 0.75], [0.80, 0.80, 0.78], [0.95, 0.50, 0.08], [0.65, 0.03, 0.03]])


def stretch_colors(stretch):
    """RGBA (n, 4) in float32 of stretch values (n,), where 1 is even sampling: blue below it, grey at it, red above."""
    values = numpy.asarray(stretch, dtype=numpy.float64)
    usable = numpy.isfinite(values) & (values > 0)
    logarithms = numpy.log2(numpy.where(usable, values, 1.0))
    colors = numpy.ones((len(values), 4), dtype=numpy.float32)
    for channel in range(3):
        colors[:, channel] = numpy.interp(logarithms, _STOPS, _COLORS[:, channel])
    return colors
