// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "decoder/forest/level_mesh.h"
#include "decoder/transform/level_step.h"

namespace hybrid_mesh {

// Which coefficients there are on a level and what is around each: the same for writers and readers.
struct CoefficientLayout {
  struct Item {
    int vertex = -1;        // of the level's mesh
    std::uint8_t kind = 0;  // 0: side, 1: centre, 2: other
    // Components are those of the coordinates, not of a frame: an operation's vertices are far from what they are predicted by, which may be a point.
    bool unturned = false;
  };
  struct Neighbour {
    std::uint32_t item : 31;
    std::uint32_t twice : 1;  // whether it counts twice
  };
  std::vector<Item> items;
  // Of each item: others whose size tells about its own, as its own does about theirs.
  std::vector<std::size_t> first_neighbour{0};
  std::vector<Neighbour> neighbours;
  std::vector<std::uint32_t> weight;  // #items: what the neighbours count together
  // Vertices of the level's mesh without an item, and the items one edge away.
  std::vector<int> bare;
  std::vector<std::size_t> first_beside{0};
  std::vector<int> beside;
  // Vertices of the coarser mesh between which it is; -1: fewer than four.
  std::vector<std::array<int, 4>> parents;
};

// `coarse`: names of the coarser mesh. With `remainder`, every vertex has an item more, after the details.
CoefficientLayout coefficient_layout(const QuadForest& forest, const LevelStep& step, const MeshNames& coarse, const LevelMesh& fine, bool remainder);

}  // namespace hybrid_mesh
