// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/protrusion.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "surface/closest_point.h"

namespace hybrid_mesh {
namespace {

std::vector<std::array<int, 3>> fans_of(const QuadMesh& mesh) {
  std::vector<std::array<int, 3>> faces;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f] + 1; i + 1 < mesh.offsets[f + 1]; ++i)
      faces.push_back({mesh.indices[mesh.offsets[f]], mesh.indices[i], mesh.indices[i + 1]});
  return faces;
}

double area_of(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces) {
  double area = 0;
  for (const auto& [a, b, c] : faces) area += 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).norm();
  return area;
}

// -1 for a closed surface whose normals point inwards, else 1.
double outwards(const TriangleSurface& surface) {
  if (std::find(surface.opposite.begin(), surface.opposite.end(), -1) != surface.opposite.end()) return 1;
  double volume = 0;  // six times
  for (const auto& [a, b, c] : surface.faces) volume += surface.points[a].dot(surface.points[b].cross(surface.points[c]));
  return volume < 0 ? -1 : 1;
}

}  // namespace

double protrusion(const TriangleSurface& surface, const Placement& placement, const QuadMesh& mesh) {
  constexpr double least_cosine = 0.3;  // between the mesh's normal and the way to a point outside: at its sharp edges it is not 1
  const std::vector<std::array<int, 3>> faces = fans_of(mesh);
  const SurfaceDistanceQuery query(mesh.points, faces);
  const double sign = outwards(surface);
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, surface.points.size()), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double most) {
        for (std::size_t v = range.begin(); v < range.end(); ++v) {
          const Vec3 p = placement.to_unit(surface.points[v]);
          const ClosestPoint closest = query.closest(p);
          Vec3 out = p;
          for (int i = 0; i < 3; ++i) out -= closest.weights[i] * mesh.points[faces[closest.face][i]];
          const auto& [a, b, c] = faces[closest.face];
          const Vec3 normal = sign * (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).normalized();
          if (out.dot(normal) > least_cosine * out.norm()) most = std::max(most, out.norm());
        }
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
}

double mean_width(const QuadMesh& mesh) { return std::sqrt(area_of(mesh.points, fans_of(mesh)) / static_cast<double>(mesh.face_count())); }

}  // namespace hybrid_mesh
