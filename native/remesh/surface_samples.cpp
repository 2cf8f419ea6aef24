// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/surface_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hybrid_mesh {

namespace {

// Quads of the leaf's size to a root quad, at a place in the root's square.
double fineness(const HybridMesh& hierarchy, int node, double u, double v, int finest) {
  while (hierarchy.first_child(node) >= 0 && hierarchy.level(node) < finest) {
    const int right = u >= 0.5, upper = v >= 0.5;
    node = hierarchy.first_child(node) + (upper ? 3 - right : right);
    u = 2 * u - right;
    v = 2 * v - upper;
  }
  return std::ldexp(1.0, 2 * hierarchy.level(node));
}

}  // namespace

SurfaceSamples::SurfaceSamples(const HybridMesh& hierarchy, std::int64_t count, int finest) {
  double total = 0;
  const std::vector<int> roots = hierarchy.roots();
  const auto normal_of = [](const PatchMap& m, const std::array<int, 3>& t) { return Vec3((m.positions[t[1]] - m.positions[t[0]]).cross(m.positions[t[2]] - m.positions[t[0]])); };
  for (const int root : roots)
    if (const PatchMap* map = hierarchy.map(root))
      for (const auto& t : map->triangles) {
        const Vec2 c = (map->uv[t[0]] + map->uv[t[1]] + map->uv[t[2]]) / 3;
        const double f = fineness(hierarchy, root, c.x(), c.y(), finest);
        total += 0.5 * normal_of(*map, t).norm() * f;
      }
  if (!(total > 0)) return;
  const double density = static_cast<double>(count) / total;
  double area = 0;
  std::int64_t made = 0;
  for (const int root : roots) {
    const PatchMap* map = hierarchy.map(root);
    if (!map) continue;
    for (const auto& t : map->triangles) {
      const Vec3 n = normal_of(*map, t);
      const double l = n.norm();
      const Vec2 middle = (map->uv[t[0]] + map->uv[t[1]] + map->uv[t[2]]) / 3;
      const double f = fineness(hierarchy, root, middle.x(), middle.y(), finest);
      area += 0.5 * l * f;
      for (const std::int64_t target = static_cast<std::int64_t>(area * density); made < target; ++made) {
        // Roberts' R2 sequence, folded into the triangle.
        double a = 0.5 + 0.7548776662466927 * static_cast<double>(made), b = 0.5 + 0.5698402909980532 * static_cast<double>(made);
        a -= std::floor(a);
        b -= std::floor(b);
        if (a + b > 1) a = 1 - a, b = 1 - b;
        const double c = 1 - a - b;
        const Vec2 uv = c * map->uv[t[0]] + a * map->uv[t[1]] + b * map->uv[t[2]];
        samples_.push_back({c * map->positions[t[0]] + a * map->positions[t[1]] + b * map->positions[t[2]], n / l, 1 / f, {root, uv.x(), uv.y()}});
      }
    }
  }
}

std::vector<FitSample> SurfaceSamples::on(const HybridMesh& hierarchy, const QuadMesh& mesh) const {
  // A node's faces, as a list; several where the leaf was closed.
  std::vector<int> face_of(hierarchy.node_count(), -1), next(mesh.face_count(), -1);
  std::vector<Vec3> middle(mesh.face_count());
  for (std::size_t f = mesh.face_count(); f-- > 0;) {
    next[f] = face_of[mesh.node[f]];
    face_of[mesh.node[f]] = static_cast<int>(f);
    Vec3 sum = Vec3::Zero();
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) sum += mesh.points[mesh.indices[i]];
    middle[f] = sum / static_cast<double>(mesh.offsets[f + 1] - mesh.offsets[f]);
  }
  std::vector<FitSample> out;
  out.reserve(samples_.size());
  for (const Sample& s : samples_) {
    int node = s.location.node;
    double u = s.location.u, v = s.location.v;
    while (face_of[node] < 0 && hierarchy.first_child(node) >= 0) {
      const int right = u >= 0.5, upper = v >= 0.5;
      node = hierarchy.first_child(node) + (upper ? 3 - right : right);
      u = 2 * u - right;
      v = 2 * v - upper;
    }
    // Under a quad that an irregular operation removed, any face is as good to start from as another.
    int face = std::max(0, face_of[node]);
    for (int f = next[face]; f >= 0; f = next[f])
      if ((middle[f] - s.position).squaredNorm() < (middle[face] - s.position).squaredNorm()) face = f;
    out.push_back({s.position, s.normal, s.weight, face});
  }
  return out;
}

}  // namespace hybrid_mesh
