// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/search/layout_levels.h"

namespace hybrid_mesh {

// How the layout of one level is improved.
struct LevelSearchOptions {
  GlobalMapOptions map;
  double vertices = 0;            // of the version of the surface that is worked on
  int quads = 0;                  // the layout may grow to at most so many; where it has more already, by a third
  double price = 0.1;             // energy that a further quad must save, in quads
  double irregular_price = 0.06;  // ... and a further irregular node
  int rounds = 4;                 // of edits, and of smoothing after each
  int trials = 80;                // edits tried out in a round, at most
  double threshold = 0;           // of energy a quad beyond an isometry's, below which no edits are tried
  double even_quads = 0;  // above 0: regions of uneven quads are laid out anew first, so that the level has about `even_quads` quads, as far as the
                          // new ones can be of their size
  double uneven = 0;      // energy beyond an isometry's above which a quad is uneven
};

struct LayoutSearchOptions {
  std::vector<LevelSearchOptions> levels;  // the base, and the levels above it that are worked on
};

// Smooths the map of a cut surface, and improves its layout by local edits between: each is tried out, the region and its surroundings mapped anew,
// and kept where the map's energy falls. Then the same with the quads quadrisected, level by level, each on a finer version of the surface. `map`
// comes with a cut surface. Throws NoMap where a map cannot be found or carried to the surface.
MappedLayouts search_layout(CarriedMap map, const LayoutSearchOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
