// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/search/base_map.h"
#include "remesh/plan.h"
#include "remesh/working_surface.h"

namespace hybrid_mesh {

struct RegionEdit {
  int level = 0;
  LayoutEdit edit;
};

// Lays out a plan's regions anew, coarse ones first, those of one level in their order; returns what was done, in the order in which it was. `map`:
// of `surface`, which `placement` has brought to unit size, to the base domain and the levels that have operations already; it is changed. Throws
// LayoutError with places in the input's space, Error{InvalidInput} with the place in the plan, Error{Unsupported} if no map is found.
std::vector<RegionEdit> repatch_regions(const TriangleSurface& surface, BaseMap& map, const std::vector<Plan::Region>& regions,
                                        const Placement& placement, const Progress& progress);

}  // namespace hybrid_mesh
