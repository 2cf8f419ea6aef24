// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/search/carried_map.h"
#include "layout/search/layout_script.h"

namespace hybrid_mesh {

// How a layout is improved.
struct LayoutSearchOptions {
  GlobalMapOptions map;
  double vertices = 0;            // of the version of the surface that is worked on
  int quads = 0;                  // the layout may grow to at most so many
  double price = 0.1;             // energy that a further quad must save, in quads
  double irregular_price = 0.06;  // ... and a further irregular node
  int rounds = 4;                 // of edits, and of smoothing after each
  int trials = 80;                // edits tried out in a round, at most
};

struct SearchedLayout {
  CarriedMap map;
  LayoutScript script;  // what was done
};

// Smooths the map of a cut surface, and improves its layout by local edits between: each is tried out, the region and its surroundings mapped anew,
// and kept where the map's energy falls. `map` comes with a cut surface. Throws NoMap where a map cannot be found.
SearchedLayout search_layout(CarriedMap map, const LayoutSearchOptions& options, const Progress& progress);

// What a script says instead of a search. Throws NoMap, too, if the layout has no such patches as the script names.
CarriedMap replay_layout(CarriedMap map, const LayoutScript& script, const Progress& progress);

}  // namespace hybrid_mesh
