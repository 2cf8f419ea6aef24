// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/outlines.h"

#include <array>
#include <utility>

namespace hybrid_mesh {

LayoutOutline outline_of_base(const HybridMesh& hierarchy, const QuadGraph& base) {
  constexpr int parts = 4;
  constexpr std::array<std::array<double, 2>, 4> corner{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  LayoutOutline outline;
  outline.quads = base.nodes;
  outline.neighbours = base.neighbours;
  outline.nodes.resize(base.node_count);
  outline.sides.resize(base.patch_count());
  for (int q = 0; q < base.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      const auto &from = corner[i], &to = corner[(i + 1) % 4];
      const auto at = [&](double t) { return hierarchy.sample({q, (1 - t) * from[0] + t * to[0], (1 - t) * from[1] + t * to[1]}).position; };
      outline.nodes[base.nodes[q][i]] = at(0);
      const PatchSide& other = base.neighbours[q][i];
      // Each line once.
      if (other.patch >= 0 && std::pair(other.patch, other.side) < std::pair(q, i)) continue;
      for (int k = 0; k <= parts; ++k) outline.sides[q][i].push_back(at(static_cast<double>(k) / parts));
    }
  return outline;
}

}  // namespace hybrid_mesh
