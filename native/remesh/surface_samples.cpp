// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/surface_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/r2_sequence.h"

namespace hybrid_mesh {

namespace {

// Quads of the leaf's size to a root quad, at a place in the square of a node that owns a map; 0 where the map does not count there: below it the
// quads have another map, or an irregular operation has removed them.
double fineness(const HybridMesh& hierarchy, int node, double u, double v, int finest) {
  while (hierarchy.first_child(node) >= 0 && hierarchy.level(node) < finest) {
    const int right = u >= 0.5, upper = v >= 0.5;
    node = hierarchy.first_child(node) + (upper ? 3 - right : right);
    if (!hierarchy.is_active(node) || hierarchy.map(node)) return 0;
    u = 2 * u - right;
    v = 2 * v - upper;
  }
  return std::ldexp(1.0, 2 * hierarchy.level(node));
}

// Is there any place in the node's square where a map of its own, or from above it, counts?
bool counts_somewhere(const HybridMesh& hierarchy, int node, int finest) {
  if (hierarchy.first_child(node) < 0 || hierarchy.level(node) >= finest) return true;
  for (int k = 0; k < 4; ++k) {
    const int child = hierarchy.first_child(node) + k;
    if (hierarchy.is_active(child) && !hierarchy.map(child) && counts_somewhere(hierarchy, child, finest)) return true;
  }
  return false;
}

// The nodes whose maps count in the mesh of leaves up to a level.
std::vector<int> map_owners(const HybridMesh& hierarchy, int finest) {
  std::vector<int> owners, stack = hierarchy.roots();
  std::reverse(stack.begin(), stack.end());
  while (!stack.empty()) {
    const int n = stack.back();
    stack.pop_back();
    if (hierarchy.level(n) > finest || !hierarchy.is_active(n)) continue;
    if (hierarchy.map(n) && counts_somewhere(hierarchy, n, finest)) owners.push_back(n);
    if (hierarchy.first_child(n) >= 0)
      for (int k = 3; k >= 0; --k) stack.push_back(hierarchy.first_child(n) + k);
  }
  return owners;
}

}  // namespace

SurfaceSamples::SurfaceSamples(const HybridMesh& hierarchy, std::int64_t count, int finest, const SizeField* sizes)
    : SurfaceSamples(hierarchy, map_owners(hierarchy, finest), count, finest, sizes) {}

SurfaceSamples::SurfaceSamples(const HybridMesh& hierarchy, const std::vector<int>& owners, std::int64_t count, int finest, const SizeField* sizes) {
  double total = 0;
  const auto normal_of = [](const PatchMap& m, const std::array<int, 3>& t) {
    return Vec3((m.positions[t[1]] - m.positions[t[0]]).cross(m.positions[t[2]] - m.positions[t[0]]));
  };
  // A triangle may reach over into where its map does not count: judged by a few of its points.
  const auto density_of = [&](int owner, const PatchMap& m, const std::array<int, 3>& t, const std::vector<double>& finer) {
    const Vec2 c = (m.uv[t[0]] + m.uv[t[1]] + m.uv[t[2]]) / 3;
    double sum = fineness(hierarchy, owner, c.x(), c.y(), finest);
    for (const int v : t) {
      const Vec2 p = 0.3 * c + 0.7 * m.uv[v];
      sum += fineness(hierarchy, owner, p.x(), p.y(), finest);
    }
    const double length = fineness_on_face(finer, t[0], t[1], t[2]);
    return sum / 4 * length * length;
  };
  const auto finer_at = [&](const PatchMap& m) { return sizes ? sizes->fineness(m.positions) : std::vector<double>(); };
  for (const int owner : owners) {
    const PatchMap& map = *hierarchy.map(owner);
    const std::vector<double> finer = finer_at(map);
    for (const auto& t : map.triangles) total += 0.5 * normal_of(map, t).norm() * density_of(owner, map, t, finer);
  }
  if (!(total > 0)) return;
  const double density = static_cast<double>(count) / total;
  double area = 0;
  std::int64_t made = 0;
  for (const int owner : owners) {
    const PatchMap& map = *hierarchy.map(owner);
    const std::vector<double> finer = finer_at(map);
    for (const auto& t : map.triangles) {
      const Vec3 n = normal_of(map, t);
      const double l = n.norm();
      const double f = density_of(owner, map, t, finer);
      area += 0.5 * l * f;
      for (const std::int64_t target = static_cast<std::int64_t>(area * density); made < target; ++made) {
        const auto [a, b] = r2_in_triangle(made);
        const double c = 1 - a - b;
        const Vec2 uv = c * map.uv[t[0]] + a * map.uv[t[1]] + b * map.uv[t[2]];
        if (fineness(hierarchy, owner, uv.x(), uv.y(), finest) == 0) continue;
        samples_.push_back({c * map.positions[t[0]] + a * map.positions[t[1]] + b * map.positions[t[2]], n / l, 1 / f, {owner, uv.x(), uv.y()}});
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
    int face = std::max(0, face_of[node]);
    for (int f = next[face]; f >= 0; f = next[f])
      if ((middle[f] - s.position).squaredNorm() < (middle[face] - s.position).squaredNorm()) face = f;
    out.push_back({s.position, s.normal, s.weight, face});
  }
  return out;
}

PolygonSoup mapped_surface(const HybridMesh& hierarchy) {
  PolygonSoup soup;
  for (const int owner : map_owners(hierarchy, HybridMesh::max_level)) {
    const PatchMap& map = *hierarchy.map(owner);
    for (const auto& t : map.triangles) {
      const Vec2 middle = (map.uv[t[0]] + map.uv[t[1]] + map.uv[t[2]]) / 3;
      if (fineness(hierarchy, owner, middle.x(), middle.y(), HybridMesh::max_level) == 0) continue;
      for (const int v : t) {
        soup.indices.push_back(static_cast<std::int32_t>(soup.points.size()));
        soup.points.push_back(map.positions[v]);
      }
      soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
    }
  }
  return soup;
}

}  // namespace hybrid_mesh
