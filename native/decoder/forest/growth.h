// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "decoder/forest/quad_forest.h"

namespace hybrid_mesh {

// Says what a hierarchy becomes while it grows in canonical order from its base: first whether each node of a level has children, in the order of
// their numbers, then what operations the next level has.
class Growth {
 public:
  virtual ~Growth() = default;
  virtual bool refined(const QuadForest& mesh, int node) = 0;
  // Makes the next operation of a level, with its sides; false: there are no more.
  virtual bool operation(const QuadForest& mesh, int level, Repatch& repatch) = 0;
};

// Grows until no node of a level has children and there are no more than `most_nodes` nodes. Throws Error{InvalidInput} where there would be more, or
// where an operation or the whole is not valid. What leaf_counts() says afterwards is of the base.
QuadForest grow(QuadForest base, Growth& growth, int most_nodes);

}  // namespace hybrid_mesh
