// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "layout/region_layout.h"
#include "parameterization/global_map.h"

namespace hybrid_mesh {

struct LayoutSearchOptions {
  GlobalMapOptions map;
  int quads = 0;           // the layout may grow up to so many
  double price = 0.1;      // energy that a further quad must save, in quads
  double irregular_price = 0.06;  // ... and a further irregular node
  int rounds = 4;
  int trials = 80;         // a round
};

struct LayoutSearchResult {
  ChartMesh charts;
  std::vector<LayoutEdit> edits;  // first one first
};

// Smooths the map of a patched surface, and improves its layout by local edits between: each is tried out, the region and its surroundings mapped anew, and kept where the map's
// energy falls. `surface` becomes the one with the layout found, cut along it. Returns its smooth map and the edits that led there. `faces`: what the points of `surface` name as their source.
LayoutSearchResult search_layout(PatchedSurface& surface, const std::vector<std::array<int, 3>>& faces, const LayoutSearchOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
