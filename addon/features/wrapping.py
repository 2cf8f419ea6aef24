# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences in a sidebar, which is narrow."""

import textwrap


def draw_wrapped(context, layout, text):
    """A sentence in lines that fit the region."""
    column = layout.column(align=True)
    for line in textwrap.wrap(text, max(12, int(context.region.width / (8 * context.preferences.system.ui_scale)))):
        column.label(text=line)
