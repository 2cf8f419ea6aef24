// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/quadric.h"

#include <Eigen/Geometry>

namespace hybrid_mesh {

void add_face(const EditMesh& mesh, const std::vector<Vec3>& points, int f, std::vector<VertexQuadric>& quadrics) {
  const int h = 3 * f;
  const Vec3 &a = points[mesh.from(h)], &b = points[mesh.to(h)], &c = points[mesh.apex(h)];
  const Vec3 n = (b - a).cross(c - a);
  const double length = n.norm();
  if (length > 0) {
    Quadric q;
    const Vec3 unit = n / length;
    q.add_plane(unit, -unit.dot(a), length / 6);
    for (int i = 0; i < 3; ++i) {
      quadrics[mesh.from(h + i)].planes += q;
      quadrics[mesh.from(h + i)].area += length / 6;
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (mesh.opposite[h + i] >= 0) continue;
    // The boundary curve is held by planes along it, upright on the face.
    const Vec3 e = points[mesh.to(h + i)] - points[mesh.from(h + i)];
    Vec3 side = length > 0 ? e.cross(n / length) : Vec3::Zero();
    const double l = side.norm();
    if (l == 0) continue;
    side /= l;
    Quadric q;
    q.add_plane(side, -side.dot(points[mesh.from(h + i)]), e.squaredNorm());
    quadrics[mesh.from(h + i)].planes += q;
    quadrics[mesh.to(h + i)].planes += q;
  }
}

}  // namespace hybrid_mesh
