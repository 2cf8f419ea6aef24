// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "remesh/fit.h"

namespace hybrid_mesh {

double scaled_jacobian(const std::array<Vec3, 4>& p) {
  const Vec3 normal = (p[2] - p[0]).cross(p[3] - p[1]);
  double least = 1;
  for (int i = 0; i < 4; ++i) {
    const Vec3 a = p[(i + 1) % 4] - p[i], b = p[(i + 3) % 4] - p[i];
    const double l = std::sqrt(a.squaredNorm() * b.squaredNorm() * normal.squaredNorm());
    least = std::min(least, l > 0 ? a.cross(b).dot(normal) / l : 0.0);
  }
  return least;
}

double scaled_jacobian(const QuadMesh& mesh, std::size_t face) {
  std::array<Vec3, 4> corners;
  for (int i = 0; i < 4; ++i) corners[i] = mesh.points[mesh.indices[mesh.offsets[face] + i]];
  return scaled_jacobian(corners);
}

std::vector<int> inverted_quads(const QuadMesh& mesh) {
  std::vector<int> inverted;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    if (mesh.offsets[f + 1] - mesh.offsets[f] == 4 && scaled_jacobian(mesh, f) <= 0) inverted.push_back(static_cast<int>(f));
  return inverted;
}

QuadQuality quad_quality(const QuadMesh& mesh) {
  QuadQuality q;
  std::vector<double> jacobians;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int64_t n = mesh.offsets[f + 1] - mesh.offsets[f];
    q.triangles += n == 3;
    if (n != 4) continue;
    jacobians.push_back(scaled_jacobian(mesh, f));
    if (jacobians.size() == 1 || jacobians.back() < q.jacobian_min) q.jacobian_min = jacobians.back(), q.worst = f;
  }
  q.quads = static_cast<std::int64_t>(jacobians.size());
  if (jacobians.empty()) return q;
  std::sort(jacobians.begin(), jacobians.end());
  q.jacobian_p05 = jacobians[jacobians.size() / 20];
  q.jacobian_median = jacobians[jacobians.size() / 2];
  q.inverted = static_cast<double>(std::upper_bound(jacobians.begin(), jacobians.end(), 0.0) - jacobians.begin()) / jacobians.size();
  return q;
}

std::vector<char> irregular_vertices(const QuadMesh& mesh) {
  std::vector<int> valence(mesh.points.size(), 0);
  for (const std::int32_t v : mesh.indices) ++valence[v];
  std::vector<char> irregular = boundary_vertices(mesh);
  for (std::size_t v = 0; v < irregular.size(); ++v) irregular[v] = !irregular[v] && valence[v] != 4;
  return irregular;
}

}  // namespace hybrid_mesh
