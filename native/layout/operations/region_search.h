// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/operations/edit_candidates.h"
#include "layout/operations/region_repatch.h"

namespace hybrid_mesh {

// Regions of a level that are better laid out in another way, disjoint with the rings around them: rings and towers for what sticks out, turned sides
// and nodes. Each was tried out at its own cost; they may be repatched one after the other.
std::vector<RegionRepatch> find_regions(const LevelState& state, const EditCandidateOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
