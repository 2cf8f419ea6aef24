# SPDX-License-Identifier: GPL-3.0-or-later
"""What the source's surface carries, brought over to a level: material indices for now of the face under each new face."""

import numpy


def carrier(obj, depsgraph, source):
    """A function carry(mesh, MeshDict) for levels.build."""

    def carry(mesh, arrays):
        triangle = arrays.get("source_face")
        if triangle is None or len(obj.material_slots) < 2:
            return
        offsets = numpy.asarray(arrays["offsets"])
        corner_triangle = numpy.asarray(triangle)[numpy.asarray(arrays["indices"])]
        known = corner_triangle[offsets[:-1]]
        materials = source.polygon_materials[source.triangle_polygons[numpy.clip(known, 0, len(source.triangle_polygons) - 1)]]
        mesh.polygons.foreach_set("material_index", materials.astype(numpy.int32))

    return carry
