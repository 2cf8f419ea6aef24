# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that fit Blender's data-blocks; no bpy."""

LIMIT = 63  # bytes of UTF-8; Blender cuts off what is longer
NUMBER = 4  # room for the .001 that Blender adds to a name that is taken


def with_suffix(name, suffix):
    """NAME and a suffix, with NAME shortened at a character so that the suffix is never what is cut off."""
    room = LIMIT - NUMBER - len(suffix.encode())
    return name.encode("utf-8", errors="replace")[: max(room, 0)].decode("utf-8", errors="ignore") + suffix


def readable(text):
    """A text that may have names of files in it, without what is no character: Blender refuses to report that."""
    return text.encode("utf-8", errors="replace").decode("utf-8")
