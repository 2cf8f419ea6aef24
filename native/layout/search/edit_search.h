// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/operations/edit_candidates.h"
#include "layout/search/trial_map.h"

namespace hybrid_mesh {

struct EditSearchOptions {
  GlobalMapOptions map;
  EditCandidateOptions candidates;
};

// Edits of disjoint regions, each of which saves more energy of the map than its quads cost: each is tried out, the region and its surroundings
// mapped anew. `map`: begun.
std::vector<LayoutEdit> find_edits(const TrialMap& map, const EditSearchOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
