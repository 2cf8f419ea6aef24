// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace hybrid_mesh {

// Point i of a sequence that is spread evenly over a triangle, as barycentrics of its second and third corner.
// Based on: Roberts, The unreasonable effectiveness of quasirandom sequences, 2018 (the R2 sequence; here folded into the triangle).
inline std::array<double, 2> r2_in_triangle(std::int64_t i) {
  double a = 0.5 + 0.7548776662466927 * static_cast<double>(i), b = 0.5 + 0.5698402909980532 * static_cast<double>(i);
  a -= std::floor(a);
  b -= std::floor(b);
  if (a + b > 1) return {1 - a, 1 - b};
  return {a, b};
}

}  // namespace hybrid_mesh
