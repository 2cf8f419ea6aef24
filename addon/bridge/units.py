# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths in the units of a scene."""

import bpy


def length_text(scene, length):
    """A length of the scene as Blender writes it, "0.9 mm" for one."""
    units = scene.unit_settings
    if units.system == "NONE":
        return f"{length:.3g}"
    return bpy.utils.units.to_string(units.system, "LENGTH", length * units.scale_length, precision=3, split_unit=False)
