// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/mesh_features.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hybrid_mesh {

MeshFeatures::MeshFeatures(const TriangleSurface& surface, const FeatureGraph& graph, const EditMesh& mesh) {
  if (graph.empty()) return;
  curve_.assign(mesh.edge_count, -1);
  on_curve_.assign(surface.points.size(), 0);
  corner_ = graph.corners;
  std::vector<std::vector<int>> around(surface.points.size());
  for (int h = 0; h < static_cast<int>(graph.edges.size()); ++h)
    if (graph.edges[h]) {
      on_curve_[surface.from(h)] = 1;
      around[surface.from(h)].push_back(h);
    }
  const auto follow = [&](int h) {
    while (curve_[mesh.edge[h]] < 0) {
      curve_[mesh.edge[h]] = curve_count_;
      const int v = surface.to(h);
      if (corner_[v]) break;
      for (const int g : around[v])
        if (mesh.edge[g] != mesh.edge[h]) {
          h = g;
          break;
        }
    }
    ++curve_count_;
  };
  for (const bool from_corners : {true, false})
    for (std::size_t v = 0; v < around.size(); ++v)
      for (const int h : around[v])
        if ((!from_corners || corner_[v]) && curve_[mesh.edge[h]] < 0) follow(h);
}

std::vector<char> MeshFeatures::marks() const {
  std::vector<char> marks(curve_.size(), 0);
  for (std::size_t e = 0; e < marks.size(); ++e) marks[e] = curve_[e] >= 0;
  return marks;
}

bool MeshFeatures::keeps_room(const EditMesh& mesh, int h) const {
  if (curve_.empty()) return true;
  const auto is_smooth = [&](int v) { return on_curve_[v] && !corner_[v]; };
  const int o = mesh.opposite[h], inner = EditMesh::prev(h), beyond = mesh.opposite[inner];
  if (beyond >= 0 && is_smooth(mesh.apex(h)) && on(mesh, EditMesh::next(h)) && on(mesh, EditMesh::next(beyond))) return false;
  if (o < 0) return true;
  const int other_beyond = mesh.opposite[EditMesh::next(o)];
  if (other_beyond >= 0 && is_smooth(mesh.apex(o)) && on(mesh, EditMesh::prev(o)) && on(mesh, EditMesh::prev(other_beyond))) return false;
  const bool is_thin = beyond >= 0 && mesh.to(EditMesh::next(beyond)) == mesh.apex(o);
  return !(is_thin && is_smooth(mesh.to(h)) && on(mesh, EditMesh::next(h)) && on(mesh, EditMesh::prev(o)));
}

bool MeshFeatures::can_flip(const EditMesh& mesh, int h) const {
  if (curve_.empty()) return true;
  if (on(mesh, h)) return false;
  const int o = mesh.opposite[h];
  const auto is_straight = [&](int v, int g, int k) { return on_curve_[v] && !corner_[v] && on(mesh, g) && on(mesh, k); };
  return !is_straight(mesh.from(h), EditMesh::prev(h), EditMesh::next(o)) && !is_straight(mesh.to(h), EditMesh::next(h), EditMesh::prev(o));
}

bool MeshFeatures::can_collapse(const EditMesh& mesh, int h) const {
  if (curve_.empty() || !on_curve_[mesh.from(h)]) return true;
  if (corner_[mesh.from(h)] || !on(mesh, h)) return false;
  // The curve's other edge must not be merged with one that is on none.
  const int o = mesh.opposite[h];
  return !on(mesh, EditMesh::prev(h)) && (o < 0 || !on(mesh, EditMesh::next(o)));
}

std::vector<int> MeshFeatures::along(const EditMesh& mesh, int v) const {
  std::vector<int> out;
  int h = mesh.out[v];
  do {
    if (on(mesh, h)) out.push_back(h);
    h = mesh.ccw(h);
  } while (h >= 0 && h != mesh.out[v]);
  return out;
}

MeshFeatures::Sector MeshFeatures::sector(const EditMesh& mesh, int h) const {
  Sector s{h, h};
  if (!is_on_curve(mesh.from(h)) && !mesh.is_boundary(mesh.from(h))) return s;
  while (!on(mesh, s.first) && mesh.opposite[s.first] >= 0) {
    s.first = mesh.cw(s.first);
    if (s.first == h) return s;
  }
  do {
    s.last = mesh.ccw(s.last);
  } while (s.last >= 0 && s.last != s.first && !on(mesh, s.last));
  return s;
}

double MeshFeatures::sector_angle(const EditMesh& mesh, const std::vector<Vec3>& points, const Sector& sector) const {
  const int v = mesh.from(sector.first);
  if (!is_corner(v)) return std::numbers::pi;
  double angle = 0;
  int g = sector.first;
  do {
    const Vec3 a = points[mesh.to(g)] - points[v], b = points[mesh.apex(g)] - points[v];
    angle += std::atan2(a.cross(b).norm(), a.dot(b));
    g = mesh.ccw(g);
  } while (g >= 0 && g != sector.last && g != sector.first);
  return angle;
}

int MeshFeatures::regular_quads(const EditMesh& mesh, const std::vector<Vec3>& points, const Sector& sector) const {
  return std::max(1, static_cast<int>(std::lround(sector_angle(mesh, points, sector) / (0.5 * std::numbers::pi))));
}

int MeshFeatures::sector_triangles(const EditMesh& mesh, const Sector& sector) {
  int triangles = 0, g = sector.first;
  do {
    ++triangles;
    g = mesh.ccw(g);
  } while (g >= 0 && g != sector.last && g != sector.first);
  return triangles;
}

}  // namespace hybrid_mesh
