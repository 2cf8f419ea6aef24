# SPDX-License-Identifier: GPL-3.0-or-later
from ..levels.making import MakingOperator
from . import conversion


class HYBRID_MESH_OT_convert_to_multires(MakingOperator):
    """Make an object with a Multires modifier, ready for sculpting: its mesh is the last level with irregular operations, or the base, and the levels above that are Multires levels"""

    bl_idname = "hybrid_mesh.convert_to_multires"
    bl_label = "Convert to Multires"
    bl_options = {"REGISTER", "UNDO"}

    def work(self, context, collection):
        return conversion.convert(context, collection)
