// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/surface_frames.h"

#include <cmath>

namespace hybrid_mesh {

namespace {

double dot(const Vec3& a, const Vec3& b) { return (a.x() * b.x() + a.y() * b.y()) + a.z() * b.z(); }

Vec3 cross(const Vec3& a, const Vec3& b) { return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()}; }

// Of areas and lengths where the whole surface has a diagonal of about 1: below, there is nothing but rounding.
constexpr double rounding = 1e-12;

// False if it has no direction.
bool normalise(Vec3& v) {
  const double length = std::sqrt(dot(v, v));
  if (!(length > rounding)) return false;
  v = {v.x() / length, v.y() / length, v.z() / length};
  return true;
}

void subtract_along(Vec3& v, const Vec3& normal) {
  const double height = dot(v, normal);
  v = {v.x() - height * normal.x(), v.y() - height * normal.y(), v.z() - height * normal.z()};
}

Frame frame_of(Vec3 normal, Vec3 tangent) {
  if (!normalise(normal)) return coordinate_axes;
  if (!normalise(tangent)) tangent.setZero();
  subtract_along(tangent, normal);
  // A direction that is almost the normal is none.
  if (dot(tangent, tangent) < 1e-6) {
    tangent = std::abs(normal.x()) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    subtract_along(tangent, normal);
  }
  normalise(tangent);
  return {normal, tangent, cross(normal, tangent)};
}

}  // namespace

SurfaceFrames::SurfaceFrames(const QuadMesh& mesh, const std::vector<Vec3>& points) : directions_(points.size()) {
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int64_t first = mesh.offsets[f], last = mesh.offsets[f + 1];
    const Vec3& origin = points[mesh.indices[first]];
    Vec3 area = Vec3::Zero();
    for (std::int64_t c = first + 1; c + 1 < last; ++c) area += cross(points[mesh.indices[c]] - origin, points[mesh.indices[c + 1]] - origin);
    for (std::int64_t c = first; c < last; ++c) {
      Directions& at = directions_[mesh.indices[c]];
      at.normal += area;
      if (at.met) continue;
      at.met = true;
      at.tangent = points[mesh.indices[c + 1 < last ? c + 1 : first]] - points[mesh.indices[c]];
    }
  }
}

Frame SurfaceFrames::operator()(int vertex) const { return frame_of(directions_[vertex].normal, directions_[vertex].tangent); }

}  // namespace hybrid_mesh
