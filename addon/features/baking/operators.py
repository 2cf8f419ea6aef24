# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ..levels.making import MakingOperator
from . import setup

SOURCES = (
    ("SCAN", "Scan", "The object that was remeshed, as it is now"),
    ("MULTIRES", "Multires", "What Convert to Multires has made, with all that was sculpted; it is made where there is none"),
)


class HYBRID_MESH_OT_bake(MakingOperator):
    """Make an object of a level with a material and a normal map that has the details of the scan, or of what was sculpted on Multires. The images are packed into the file"""

    bl_idname = "hybrid_mesh.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}

    source: EnumProperty(name="From", description="The surface whose details are baked", items=SOURCES, default="SCAN")
    level: StringProperty(name="Level", description="The level to bake on, N2 for one; empty: the level that is shown, or the Multires object's own mesh")
    size: IntProperty(name="Size", description="Pixels of the image's side; 0: by the number of patches", default=0, min=0, max=setup.MOST_SIZE, soft_max=8192)
    displacement: BoolProperty(name="Displacement", description="Bake how far the surface lies beyond the level, too", default=False)
    floats: BoolProperty(name="32-Bit Float", description="Normals with 32 bits a number instead of 8", default=False)
    smooth: BoolProperty(name="Smooth Scan", description="Interpolate the normals of a scan that is shaded flat everywhere, but for edges of more than 40 degrees", default=True)

    def work(self, context, collection):
        return setup.bake(context, collection, setup.Settings(self.level, self.source, self.size, self.displacement, self.floats, self.smooth))
