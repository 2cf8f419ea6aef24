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


def register():
    from . import registration

    registration.register()


def unregister():
    from . import registration

    registration.unregister()
