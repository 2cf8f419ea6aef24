// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_surface.h"

#include <algorithm>
#include <utility>

namespace hybrid_mesh {

std::vector<int> RegionSurface::rim() const {
  std::vector<int> rim;
  for (const std::vector<int>& side : sides) rim.insert(rim.end(), side.begin(), side.end() - 1);
  return rim;
}

RegionSurface surface_of(const PatchedSurface& surface, const PatchRegion& region) {
  PatchedPart part = part_of(surface, region.patches);
  RegionSurface out;
  for (const PatchSide& s : region.boundary) {
    const auto patch = std::find(region.patches.begin(), region.patches.end(), s.patch) - region.patches.begin();
    out.sides.push_back(part.surface.sides[patch][s.side]);
  }
  out.mesh = std::move(part.surface.mesh);
  out.source = std::move(part.surface.source);
  out.point = std::move(part.point);
  return out;
}

}  // namespace hybrid_mesh
