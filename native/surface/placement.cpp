// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/placement.h"

namespace hybrid_mesh {

Placement placement_of(const std::vector<Vec3>& points) {
  Placement p;
  if (points.empty()) return p;
  Vec3 low = points[0], high = points[0];
  for (const Vec3& x : points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  p.center = 0.5 * low + 0.5 * high;
  // Scaled before squaring: coordinates may be anything a double holds.
  const Vec3 size = high - low;
  const double largest = size.maxCoeff();
  p.diagonal = largest > 0 ? largest * (size / largest).norm() : 1;
  return p;
}

}  // namespace hybrid_mesh
