# SPDX-License-Identifier: GPL-3.0-or-later
"""What the colours on a mesh mean: (colour, text) entries for a legend. Nothing is drawn here."""

from .colors import ERROR_STOPS, STRETCH_STOPS, error_colors, stretch_colors


def stretch_entries():
    """From the most stretched to the densest."""
    texts = {-2: "dense: 1/4", -1: "1/2", 0: "1: even", 1: "2", 2: "stretched: 4 and more"}
    stops = list(reversed(STRETCH_STOPS))
    return [(color, texts[int(stop)]) for color, stop in zip(_rgb(stretch_colors([2.0**stop for stop in stops])), stops)]


def error_entries(diagonal, length_text):
    """From the farthest to the nearest. length_text(length): a length in the scene's units."""
    stops = list(reversed(ERROR_STOPS))
    texts = [f"{length_text(stop * diagonal)} ({percent(stop)})" for stop in stops]
    texts[0] += " and more"
    texts[-1] += " and less"
    return list(zip(_rgb(error_colors(stops)), texts))


def percent(fraction):
    """A fraction as people read it: two digits that count."""
    value = 100 * fraction
    return f"{value:.0f} %" if value >= 10 else f"{value:.2g} %" if value >= 0.001 else f"{value:.0e} %" if value else "0 %"


def _rgb(colors):
    return [tuple(float(value) for value in color[:3]) for color in colors]
