// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/search/layout_script.h"
#include "layout/search/trial_map.h"

namespace hybrid_mesh {

struct EvenRegionsOptions {
  double quads = 0;       // wanted in all, as far as the new ones can be of their size
  double most_quads = 0;  // ... and at most
  double uneven = 0;      // energy beyond an isometry's, in quads, above which a quad is uneven
};

// The part of a layout's map that is uneven laid out anew.
struct EvenRegions {
  std::vector<LayoutScript::Edit> edits;  // of disjoint regions, of round 0
  std::vector<DrawnEdit> drawn;           // the same
};

// Even quads for the regions that need them. `map`: begun.
EvenRegions find_even_regions(const TrialMap& map, const EvenRegionsOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
