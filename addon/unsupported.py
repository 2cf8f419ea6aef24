# SPDX-License-Identifier: GPL-3.0-or-later
"""What there is of the add-on where its compiled module does not run: a panel, and a line on the console, that say why."""

import sys
import textwrap

import bpy

WIDTH = 38  # characters that a sidebar shows in a line as it is opened


class HYBRID_MESH_PT_unsupported(bpy.types.Panel):
    bl_idname = "HYBRID_MESH_PT_unsupported"
    bl_label = "Hybrid Mesh"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Hybrid Mesh"
    reason = ""

    def draw(self, context):
        column = self.layout.column(align=True)
        for number, line in enumerate(textwrap.wrap(self.reason, WIDTH)):
            column.label(text=line, icon="NONE" if number else "ERROR")


def register(reason):
    HYBRID_MESH_PT_unsupported.reason = reason
    bpy.utils.register_class(HYBRID_MESH_PT_unsupported)
    print(f"Hybrid Mesh: {reason}", file=sys.stderr)


def unregister():
    bpy.utils.unregister_class(HYBRID_MESH_PT_unsupported)
