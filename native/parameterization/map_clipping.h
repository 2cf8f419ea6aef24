// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parameterization/patch_map.h"

namespace hybrid_mesh {

// A square in a map's unit square: lower corner and width, which are multiples of one power of two.
struct DyadicSquare {
  double u = 0, v = 0, width = 1;
  // Quadrant k: (0, 0), (1, 0), (1, 1), (0, 1).
  DyadicSquare quadrant(int k) const { return {u + (k == 1 || k == 2 ? width / 2 : 0), v + (k >= 2 ? width / 2 : 0), width / 2}; }
  bool is_whole() const { return width == 1; }
  friend bool operator==(const DyadicSquare&, const DyadicSquare&) = default;
};

// The parts of a map over disjoint squares, each as a map from the unit square. Squares that share a side share the points on it. Triangles are cut
// along the squares' sides, all that lies between is left as it is. Throws NoMap if rounding would fold a piece.
std::vector<PatchMap> clip_map(const PatchMap& map, const std::vector<DyadicSquare>& squares);
// The same with the map's own triangles as the pieces' sources.
std::vector<PatchMap> clip_by_triangles(const PatchMap& map, const std::vector<DyadicSquare>& squares);

}  // namespace hybrid_mesh
