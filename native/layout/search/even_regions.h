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

// Even quads for the disks of patches that need them. `map`: begun.
EvenRegions find_even_regions(const TrialMap& map, const EvenRegionsOptions& options, const Progress& progress);

// Where the quads of a region's edit lie: their nodes, and lines of a few points along their sides.
LayoutOutline outline_of(const DrawnEdit& drawn, const PatchRegion& region);

// The region cut along the sides of an outline's quads; without patches if there is no way to lay them out.
PatchedSurface lay_out_region(const MappedSurface& mapped, LayoutOutline outline, const PatchRegion& region, const Progress& progress);

}  // namespace hybrid_mesh
