// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/layout_edit.h"

namespace hybrid_mesh {

// What a search has decided, so that it can be repeated without searching.
struct LayoutScript {
  struct Edit {
    LayoutEdit edit;  // in the numbers of the layout before its round
    int round = 0;    // edits of one round are of disjoint regions
  };
  double vertices = 0, vertices_a_quad = 0;  // see LayoutSearchOptions
  std::vector<Edit> edits;                   // by round
};

// The edits, a round each.
std::vector<std::vector<LayoutEdit>> rounds_of(const LayoutScript& script);

}  // namespace hybrid_mesh
