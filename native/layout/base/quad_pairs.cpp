// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/quad_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "layout/base/quad_layout.h"

namespace hybrid_mesh {
namespace {

constexpr int kOnBoundary = 2;  // quads that a node there is to have

// What it costs that a vertex on a curve gets one quad alone, which has a straight angle there. A bare boundary may turn by itself.
constexpr double kStraight = 10, kStraightOnBareBoundary = 3;

double energy_of(int quads, int regular, double straight) {
  return QuadPairs::valence_energy(quads - regular) + (quads < regular && quads == 1 ? straight : 0);
}

}  // namespace

int QuadPairs::diagonal(int f) const {
  for (int h = 3 * f; h < 3 * f + 3; ++h)
    if (mesh_.opposite[h] >= 0 && mesh_.opposite[h] / 3 == mate_[f]) return h;
  return -1;
}

QuadPairs::Corners QuadPairs::corners(int h) const {
  const int n = EditMesh::next(h), p = EditMesh::prev(h);
  if (is_diagonal(n)) return {{mesh_.from(h), mesh_.to(h), mesh_.apex(mesh_.opposite[n]), mesh_.apex(h)}};
  return {{mesh_.from(h), mesh_.to(h), mesh_.apex(h), mesh_.apex(mesh_.opposite[p])}};
}

int QuadPairs::half_at(int f, int v) const {
  for (const int g : {f, mate_[f]})
    for (int h = 3 * g; h < 3 * g + 3; ++h)
      if (mesh_.from(h) == v) return h;
  return -1;
}

double QuadPairs::badness(const std::array<int, 4>& q) const {
  std::array<Vec3, 4> p;
  for (int i = 0; i < 4; ++i) p[i] = points_[q[i]];
  const Vec3 n = (p[2] - p[0]).cross(p[3] - p[1]);
  double sum = 0;
  std::array<double, 4> length;
  for (int i = 0; i < 4; ++i) {
    const Vec3 a = p[(i + 1) % 4] - p[i], b = p[(i + 3) % 4] - p[i];
    length[i] = a.norm();
    const double l = std::sqrt(a.squaredNorm() * b.squaredNorm() * n.squaredNorm());
    sum += 1 - (l > 0 ? a.cross(b).dot(n) / l : -1.0);
  }
  const double aspect = std::log(std::max(1e-9, length[0] + length[2]) / std::max(1e-9, length[1] + length[3]));
  return sum + aspect * aspect;
}

int QuadPairs::excess(int v) const {
  int edges = 0;
  int h = mesh_.out[v];
  do {
    if (!is_diagonal(h)) ++edges;
    const int n = mesh_.ccw(h);
    if (n < 0) return edges - (boundary_quads_.empty() ? 2 : boundary_quads_[v]);
    h = n;
  } while (h != mesh_.out[v]);
  return edges - 4;
}

double QuadPairs::sector_energy(int h, int change) const {
  const int v = mesh_.from(h);
  if (is_on_bare_boundary(v)) return boundary_energy(v, excess(v) + kOnBoundary + change);
  if (!features_.is_on_curve(v)) return valence_energy(excess(v) + change);
  const MeshFeatures::Sector sector = features_.sector(mesh_, h);
  return energy_of(quads_in(sector) + change, regular_quads(sector), kStraight);
}

int QuadPairs::quads_in(const MeshFeatures::Sector& sector) const {
  int quads = 1;
  for (int g = mesh_.ccw(sector.first); g >= 0 && g != sector.last && g != sector.first; g = mesh_.ccw(g)) quads += !is_diagonal(g);
  return quads;
}

int QuadPairs::regular_quads(const MeshFeatures::Sector& sector) const { return features_.regular_quads(mesh_, points_, sector); }

bool QuadPairs::is_on_bare_boundary(int v) const {
  return !features_.is_on_curve(v) && (is_inside_mirror(v) || (boundary_quads_.empty() && mesh_.is_boundary(v)));
}

double QuadPairs::boundary_energy(int v, int quads) const {
  return energy_of(quads, kOnBoundary, is_inside_mirror(v) ? kStraight : kStraightOnBareBoundary);
}

bool QuadPairs::lacks_quads(int h, int fewer) const {
  if (const int v = mesh_.from(h); is_on_bare_boundary(v)) return excess(v) < fewer;
  const MeshFeatures::Sector sector = features_.sector(mesh_, h);
  return quads_in(sector) - fewer < regular_quads(sector);
}

double QuadPairs::cost_across(int h) const {
  constexpr double across = 1000, stuck = 100;
  const double length = (points_[mesh_.to(h)] - points_[mesh_.from(h)]).norm();
  double least = stuck;
  for (const int g : {h, mesh_.opposite[h]})
    if (can_collapse_on_feature(g)) least = std::min(least, features_.keeps_room(mesh_, g) ? 1.0 : 2.0);
  return across * (least + length);
}

double QuadPairs::diagonal_energy(int h) const {
  if (const int v = mesh_.from(h); is_on_bare_boundary(v)) {
    const int all = mesh_.valence(v) - 1;  // triangles
    return std::max(0.0, boundary_energy(v, all - 1) - boundary_energy(v, all));
  }
  if (!features_.is_on_curve(mesh_.from(h))) return 0;
  const MeshFeatures::Sector sector = features_.sector(mesh_, h);
  const int triangles = MeshFeatures::sector_triangles(mesh_, sector), regular = regular_quads(sector);
  return std::max(0.0, energy_of(triangles - 1, regular, kStraight) - energy_of(triangles, regular, kStraight));
}

QuadLayout QuadPairs::layout_of(const std::vector<int>& faces, const std::vector<int>& vertices) const {
  QuadLayout out;
  for (const int v : vertices)
    if (features_.is_on_curve(v))
      for (const int h : features_.along(mesh_, v)) out.lacking += lacks_quads(h, 0);
  std::vector<int> node(points_.size(), -1);
  for (const int v : vertices) {
    node[v] = static_cast<int>(out.node_vertex.size());
    out.node_vertex.push_back(v);
  }
  std::map<int, int> curve_of_edge;
  const auto side = [&](int h) {
    QuadLayout::Side s;
    if (mesh_.opposite[h] < 0) return s;
    const auto [it, fresh] = curve_of_edge.insert({mesh_.edge[h], static_cast<int>(out.curves.size())});
    if (fresh) out.curves.push_back({mesh_.from(h), mesh_.to(h), mesh_.edge[h]});
    s.curve = it->second;
    s.forward = out.curves[s.curve].start == mesh_.from(h);
    return s;
  };
  for (const int f : faces) {
    if (mate_[f] < f) continue;
    QuadLayout::Quad quad;
    if (is_pair(f)) {
      const int d = diagonal(f), o = mesh_.opposite[d];
      const std::array<int, 4> halves{EditMesh::next(o), EditMesh::prev(o), EditMesh::next(d), EditMesh::prev(d)};
      for (int k = 0; k < 4; ++k) {
        quad.nodes[k] = node[mesh_.from(halves[k])];
        quad.sides[k] = side(halves[k]);
      }
    } else {
      const int h = split_[f];
      const int extra = static_cast<int>(out.node_vertex.size());
      out.node_vertex.push_back(-1);
      quad.nodes = {node[mesh_.from(h)], extra, node[mesh_.to(h)], node[mesh_.apex(h)]};
      quad.sides = {QuadLayout::Side{}, QuadLayout::Side{}, side(EditMesh::next(h)), side(EditMesh::prev(h))};
    }
    out.quads.push_back(quad);
  }
  return out;
}

}  // namespace hybrid_mesh
