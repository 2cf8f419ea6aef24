// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "layout/drawn/layout_transfer.h"
#include "layout/layout_edit.h"

namespace hybrid_mesh {

// What a search has decided, level by level, so that it can be repeated without searching.
struct LayoutScript {
  struct Edit {
    LayoutEdit edit;        // in the numbers of the layout before its round
    int round = 0;          // edits of one round are of disjoint regions
    bool even = false;      // found by even_edit(); such edits form the level's first round
    double even_quads = 0;  // what even_edit() was asked for; 0: it is not to find them again
    LayoutOutline
        outline;  // of an even edit: its quads where they lay in space, the region's corners first among the nodes; without nodes: not known
    std::vector<std::string> quads;        // addresses of edit.patches, once the edit has been applied where quads have addresses
    std::vector<std::string> start_quads;  // those of the quads of edit.starts
  };
  struct Level {
    double vertices = 0, vertices_a_quad = 0;  // see LayoutSearchOptions
    std::vector<Edit> edits;                   // by round
  };
  std::vector<Level> levels;
};

// The edits of a level, a round each.
std::vector<std::vector<LayoutScript::Edit>> rounds_of(const LayoutScript::Level& level);

}  // namespace hybrid_mesh
