// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/surface_frames.h"

#include <cmath>

namespace hybrid_mesh {

namespace {

// Of areas and lengths where the whole surface has a diagonal of about 1: below, there is nothing but rounding.
constexpr double rounding = 1e-12;

// False if it has no direction.
bool normalise(Point3& v) {
  const double length = std::sqrt(dot(v, v));
  if (!(length > rounding)) return false;
  v = v / length;
  return true;
}

void subtract_along(Point3& v, const Point3& normal) {
  const double height = dot(v, normal);
  v = v - height * normal;
}

Frame frame_of(Point3 normal, Point3 tangent) {
  if (!normalise(normal)) return coordinate_axes;
  if (!normalise(tangent)) tangent = {};
  subtract_along(tangent, normal);
  // A direction that is almost the normal is none.
  if (dot(tangent, tangent) < 1e-6) {
    tangent = std::abs(normal.x) < 0.6 ? Point3{1, 0, 0} : Point3{0, 1, 0};
    subtract_along(tangent, normal);
  }
  normalise(tangent);
  return {normal, tangent, cross(normal, tangent)};
}

}  // namespace

SurfaceFrames::SurfaceFrames(const std::vector<std::int64_t>& offsets, const std::vector<std::int32_t>& indices, const Point3* points,
                             std::size_t count, const char* wanted)
    : points_(points), normal_(count), next_(count, -1) {
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
    const std::int64_t first = offsets[f], last = offsets[f + 1];
    if (wanted) {
      bool any = false;
      for (std::int64_t c = first; c < last; ++c) any |= wanted[indices[c]] != 0;
      if (!any) continue;
    }
    const Point3& origin = points[indices[first]];
    Point3 area;
    for (std::int64_t c = first + 1; c + 1 < last; ++c) area += cross(points[indices[c]] - origin, points[indices[c + 1]] - origin);
    for (std::int64_t c = first; c < last; ++c) {
      const int vertex = indices[c];
      normal_[vertex] += area;
      if (next_[vertex] < 0) next_[vertex] = indices[c + 1 < last ? c + 1 : first];
    }
  }
}

Frame SurfaceFrames::operator()(int vertex) const {
  return frame_of(normal_[vertex], next_[vertex] < 0 ? Point3() : points_[next_[vertex]] - points_[vertex]);
}

}  // namespace hybrid_mesh
