// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "layout/layout_edit.h"

namespace hybrid_mesh {

// Which edits of a layout are worth trying out, and which of those tried are worth doing. Energies are of the map beyond an isometry's, in quads.
struct EditCandidateOptions {
  int most = 0;                // quads that the layout may grow to
  double price = 0;            // energy that a further quad must save
  double irregular_price = 0;  // ... and a further irregular node
  int trials = 0;              // edits that are tried out at most, towers of several rings not counted
  double threshold = 0;        // of energy a quad, below which no edits are tried
};

struct EditCandidate {
  PatchRegion region;
  LayoutEdit edit;
  int irregular = 0;  // further irregular nodes
  double excess = 0;  // energy of the region's quads
  double gain = 0;    // energy that the edit saves: to be found by trying it out
};

// The most promising edits first: rings around a quad, two quads or the quads of a node, turned sides, turned nodes; and towers of several rings, as
// high as `tower_height` says for the region. `energy`: of each quad.
std::vector<EditCandidate> find_edit_candidates(const QuadGraph& graph, const std::vector<double>& energy, const EditCandidateOptions& options,
                                                const std::function<int(const PatchRegion&)>& tower_height);

// The best ones, by gain less price, whose regions and surroundings do not overlap.
std::vector<EditCandidate> choose_edits(const QuadGraph& graph, std::vector<EditCandidate> candidates, const EditCandidateOptions& options);

// The region's quads, then those that share a node with it.
std::vector<int> with_surroundings(const QuadGraph& graph, const PatchRegion& region);

}  // namespace hybrid_mesh
