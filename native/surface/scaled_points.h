// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// The exponent e for which 2^-e brings every coordinate into [-1, 1]: products of scaled coordinates neither overflow nor vanish, and
// scaling by a power of two rounds nothing (but coordinates 10^300 times smaller than the largest).
inline int scale_exponent(const std::vector<Vec3>& points) {
  double largest = 0;
  for (const Vec3& p : points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  int exponent = 0;
  if (largest > 0) std::frexp(largest, &exponent);
  return exponent;
}

inline Vec3 scaled(const Vec3& p, int exponent) { return {std::ldexp(p[0], -exponent), std::ldexp(p[1], -exponent), std::ldexp(p[2], -exponent)}; }

inline std::vector<Vec3> scaled(const std::vector<Vec3>& points, int exponent) {
  std::vector<Vec3> out(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = scaled(points[i], exponent);
  return out;
}

}  // namespace hybrid_mesh
