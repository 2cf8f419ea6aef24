// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/layout_edit.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// The part of a cut surface that new quads of a region are laid out on, by itself.
struct RegionSurface {
  TriangleSurface mesh;                 // source_face: as the whole has it
  std::vector<PointSource> source;      // per point
  std::vector<int> point;               // per point: that of the whole, -1: none
  std::vector<std::vector<int>> sides;  // per boundary side of the region: the points along it, both ends included

  int corner(int k) const { return sides[k].front(); }
  std::vector<int> rim() const;  // all points along the boundary sides, each side's last one left out
};

RegionSurface surface_of(const PatchedSurface& surface, const PatchRegion& region);

}  // namespace hybrid_mesh
