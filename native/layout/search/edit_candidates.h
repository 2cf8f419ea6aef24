// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/search/trial_map.h"

namespace hybrid_mesh {

struct EditSearchOptions {
  GlobalMapOptions map;
  int most = 0;                // quads that the layout may grow to
  double price = 0;            // energy that a further quad must save, in quads
  double irregular_price = 0;  // ... and a further irregular node
  int trials = 0;              // edits that are tried out at most, towers of several rings not counted
  double threshold = 0;        // of energy a quad beyond an isometry's, below which no edits are tried
};

// Edits of disjoint regions, each of which saves more energy of the map than its quads cost: rings around a quad, two quads or the quads of a node,
// towers of several rings, turned sides and turned nodes are each tried out, the region and its surroundings mapped anew. `map`: begun.
std::vector<LayoutEdit> find_edits(const TrialMap& map, const EditSearchOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
