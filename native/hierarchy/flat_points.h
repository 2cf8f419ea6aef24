// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "decoder/transform/point.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// Points as the decoder has them, and back.
inline std::vector<Point3> flat_points(const std::vector<Vec3>& points) {
  std::vector<Point3> result;
  result.reserve(points.size());
  for (const Vec3& p : points) result.push_back({p.x(), p.y(), p.z()});
  return result;
}

inline std::vector<Vec3> vectors_of(const std::vector<Point3>& points) {
  std::vector<Vec3> result;
  result.reserve(points.size());
  for (const Point3& p : points) result.emplace_back(p.x, p.y, p.z);
  return result;
}

}  // namespace hybrid_mesh
