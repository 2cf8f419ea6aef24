// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/boundary_corners.h"

#include <algorithm>
#include <utility>

#include "surface/boundary_loop.h"

namespace hybrid_mesh {

std::vector<int> boundary_corners(const TriangleSurface& surface, double window, double angle) {
  std::vector<int> corners;
  for (const BoundaryLoop& loop : boundary_loops(surface)) {
    if (!(loop.length() > 4 * window)) continue;
    std::vector<std::pair<double, int>> sharpest;
    for (int i = 0; i < loop.size(); ++i)
      if (const double turn = loop.turn(i, window); turn > angle) sharpest.push_back({-turn, i});
    std::sort(sharpest.begin(), sharpest.end());
    std::vector<int> kept;
    for (const auto& [turn, i] : sharpest)
      if (std::all_of(kept.begin(), kept.end(), [&, i = i](int k) { return loop.distance(i, k) > window; })) kept.push_back(i);
    std::sort(kept.begin(), kept.end());
    for (const int i : kept) corners.push_back(loop.vertex(i));
  }
  return corners;
}

}  // namespace hybrid_mesh
