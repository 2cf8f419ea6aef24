# SPDX-License-Identifier: GPL-3.0-or-later
"""Hybrid Mesh: scans become quad hierarchies. Importable without Blender; then only `core` and `_native` are of use."""

bl_info = {
    "name": "Hybrid Mesh",
    "author": "The Hybrid Mesh authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D Viewport > Sidebar > Hybrid Mesh",
    "description": "Turns scans into multiresolution quad meshes",
    "category": "Mesh",
}


_active = []  # the module that has registered


def register():
    from .core.native import NativeMissing, native

    try:
        native()
    except NativeMissing as error:
        # Whoever enables the add-on learns it where its buttons would be.
        from . import unsupported

        unsupported.register(f"{error}.")
        _active.append(unsupported)
        return
    from . import registration

    registration.register()
    _active.append(registration)


def unregister():
    while _active:
        _active.pop().unregister()
