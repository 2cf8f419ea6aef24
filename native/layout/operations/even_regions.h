// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/operations/region_repatch.h"

namespace hybrid_mesh {

struct EvenRegionsOptions {
  double quads = 0;       // wanted in all, as far as the new ones can be of their size
  double most_quads = 0;  // ... and at most
  double uneven = 0;      // energy beyond an isometry's, in quads, above which a quad is uneven
};

// The parts of a level that are uneven, to be laid out anew with even quads, the smallest first: disjoint regions.
std::vector<RegionRepatch> find_even_regions(const LevelState& state, const EvenRegionsOptions& options);

}  // namespace hybrid_mesh
