# SPDX-License-Identifier: GPL-3.0-or-later
"""The choice of what is shown, as it stands in the panel of a hierarchy."""


def draw_show(layout, values):
    column = layout.column(align=True)
    column.prop(values, "mode", text="")
    row = column.row(align=True)
    edges = row.row(align=True)
    edges.enabled = values.mode not in ("SHADED", "QUADS")  # which say so themselves
    edges.prop(values, "edges", toggle=True)
    row.prop(values, "legend", toggle=True)
