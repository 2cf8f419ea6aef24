// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/regions/region_surface.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {

// A region's surface without the points that the sides of its quads have cut into it, but for those of its rim: new quads have sides of their own,
// and a map moves freely where there are no small triangles. `glued`: the maps of the region's quads by the triangles out of which they were cut, see
// maps_of(); it gets the faces that are new.
RegionSurface uncut_region(const RegionSurface& part, GluedMaps& glued);

}  // namespace hybrid_mesh
