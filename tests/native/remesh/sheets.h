// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh::testing {

constexpr int kSide = 20, kMiddle = 10;  // quads

// Two sheets of squares, one above the other; the lower one has a bulge of that height around its middle.
inline QuadMesh two_sheets(double gap, double bulge) {
  QuadMesh mesh;
  for (int sheet = 0; sheet < 2; ++sheet) {
    const int first = static_cast<int>(mesh.points.size());
    for (int j = 0; j <= kSide; ++j)
      for (int i = 0; i <= kSide; ++i) {
        const double x = (i - kMiddle) / 3.0, y = (j - kMiddle) / 3.0;
        mesh.points.emplace_back(i + 0.01 * sheet, j + 0.02 * sheet, sheet == 0 ? bulge * std::exp(-x * x - y * y) : gap);
      }
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const int a = first + (kSide + 1) * j + i;
        for (const int v : {a, a + 1, a + kSide + 2, a + kSide + 1}) mesh.indices.push_back(v);
        mesh.offsets.push_back(static_cast<std::int64_t>(mesh.indices.size()));
      }
  }
  return mesh;
}

}  // namespace hybrid_mesh::testing
