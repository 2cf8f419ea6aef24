// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parameterization/patch_map.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// A patched surface and where its faces' corners lie in their patch's unit square.
struct MappedSurface {
  PatchedSurface surface;
  std::vector<std::array<Vec2, 3>> corners;
};

// The inverse of extracting: joins maps of patches along their sides to one surface. `layout` gives the patches' nodes and neighbours; the maps share
// the points along common sides. `repaired_faces` are the faces that the maps name as their source. Throws Error{Internal} if two maps do not meet
// along a side.
MappedSurface glue_patch_maps(const std::vector<PatchMap>& maps, const PatchedSurface& layout, const std::vector<std::array<int, 3>>& repaired_faces);

}  // namespace hybrid_mesh
