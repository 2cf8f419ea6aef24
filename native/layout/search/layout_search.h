// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "layout/drawn/layout_transfer.h"
#include "layout/regions/region_layout.h"
#include "layout/search/carried_map.h"
#include "parameterization/global_map.h"

namespace hybrid_mesh {

struct LayoutSearchOptions {
  GlobalMapOptions map;
  double vertices = 0;            // of the coarse surface that is worked on
  int quads = 0;                  // the layout may grow up to so many; where it has more already, by a third
  double price = 0.1;             // energy that a further quad must save, in quads
  double irregular_price = 0.06;  // ... and a further irregular node
  int rounds = 4;
  int trials = 80;        // a round
  double threshold = 0;   // of energy a quad beyond an isometry's, below which no edits are tried
  double even_quads = 0;  // regions of uneven quads are laid out anew first, so that there are about so many in all, as far as the new ones can be of
                          // their size; 0: not
  double uneven = 0;      // ... of more energy beyond an isometry's than this
  double stretch = 0;     // finer levels are worked on only where quads of the last one would cover so many times the mean area
  std::vector<LayoutSearchOptions> finer;  // of the levels above the base
};

// Edits of one level's quads, first one first.
using LevelEdits = std::vector<LayoutEdit>;

// What a search has decided, level by level, so that it can be repeated without searching.
struct LayoutScript {
  // New quads of even size for a region; see even_edit().
  struct EvenLayout {
    LayoutEdit edit;
    double quads = 0;       // 0: not to be found by even_edit()
    LayoutOutline outline;  // the edit's quads where they lay in space, the region's corners first among the nodes; without nodes: not known
  };
  struct Level {
    double vertices = 0, vertices_a_quad = 0;     // see LayoutSearchOptions
    std::vector<EvenLayout> even;                 // first; all named by the layout before any of them
    std::vector<std::vector<LayoutEdit>> rounds;  // then; those of a round named by the layout before that
  };
  std::vector<Level> levels;
};

struct LayoutSearchResult {
  std::vector<LevelEdits> edits;  // a level each
  LayoutScript script;            // the same, as it came about
  // The map of the base domain, and that of the quads of each finer level that was edited; carried to the surface if there are finer levels.
  struct Stage {
    int level;
    CarriedMap map;
  };
  std::vector<Stage> stages;
};

// Smooths the map of a cut surface, and improves its layout by local edits between: each is tried out, the region and its surroundings mapped anew,
// and kept where the map's energy falls. Then the same with the quads quadrisected, as often as there are options for finer levels, each on a finer
// version of the surface. `map` comes with a cut surface. Throws Error{Internal} where a map cannot be found or carried to the surface.
LayoutSearchResult search_layout(CarriedMap map, const LayoutSearchOptions& options, const Progress& progress);

// Does what a search did on another surface or the same; on the same, with the same result. Throws Error{Internal} as above and where the layout has
// no such quads.
LayoutSearchResult repeat_search(CarriedMap map, const LayoutScript& script, const Progress& progress);

}  // namespace hybrid_mesh
