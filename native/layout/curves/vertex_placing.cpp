// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/curves/vertex_placing.h"

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

constexpr double kAtVertex = 0.1;  // of an edge: so near to a vertex, the vertex itself is taken
constexpr double kOnEdge = 0.08;   // of a face's height: so near to an edge, that is split
constexpr double kInside = 0.05;   // least distance of a new vertex from the sides of its face, as a fraction of the height

}  // namespace

VertexPlacing::VertexPlacing(SurfaceCurves& curves) : curves_(curves), paths_(curves.mesh(), curves.points()) {
  const EditMesh& mesh = curves.mesh();
  std::vector<char> seen(mesh.edge_count, 0);
  for (int first = 0; first < static_cast<int>(mesh.opposite.size()); ++first) {
    if (mesh.opposite[first] >= 0 || seen[mesh.edge[first]]) continue;
    for (int h = first; !seen[mesh.edge[h]]; h = mesh.out[mesh.to(h)]) {
      seen[mesh.edge[h]] = 1;
      boundary_.push_back({mesh.edge[h], loops_});
    }
    ++loops_;
  }
}

std::vector<int> VertexPlacing::boundary_edges() const {
  std::vector<int> edges;
  for (const BoundaryEdge& e : boundary_) edges.push_back(e.edge);
  return edges;
}

int VertexPlacing::vertex_of_loop(int loop) const {
  const auto at = std::find_if(boundary_.begin(), boundary_.end(), [&](const BoundaryEdge& e) { return e.loop == loop; });
  return curves_.mesh().from(curves_.half_edge(at->edge));
}

int VertexPlacing::inside(const FacePoint& place) {
  const EditMesh& mesh = curves_.mesh();
  const FacePoint p = paths_.locate(place.at, place.face);
  std::array<double, 3> w{};
  nearest_in_triangle(p.at, paths_.corners(p.face), w);
  int v = -1;
  for (int i = 0; i < 3 && v < 0; ++i) {
    const int corner = mesh.from(3 * p.face + i);
    if (w[i] > 1 - kAtVertex && !taken(corner) && !mesh.is_boundary(corner)) v = corner;
  }
  for (int i = 0; i < 3 && v < 0; ++i) {
    const int h = 3 * p.face + i;
    const double t = w[(i + 1) % 3] / (w[i] + w[(i + 1) % 3]);
    if (w[(i + 2) % 3] < kOnEdge && mesh.opposite[h] >= 0 && t > kAtVertex && t < 1 - kAtVertex) v = curves_.split_edge(h, t);
  }
  if (v < 0) {
    double sum = 0;
    for (double& x : w) sum += x = std::max(x, kInside);
    for (double& x : w) x /= sum;
    v = curves_.split_face(p.face, w);
  }
  take(v);
  return v;
}

int VertexPlacing::nearest_edge(const Vec3& p, double most, int loop, double& fraction) const {
  const EditMesh& mesh = curves_.mesh();
  int found = -1;
  double best = most * most;
  for (const BoundaryEdge& e : boundary_) {
    if (loop >= 0 && e.loop != loop) continue;
    const int h = curves_.half_edge(e.edge);
    const Vec3 &from = curves_.points()[mesh.from(h)], &to = curves_.points()[mesh.to(h)];
    const double t = nearest_on_segment(p, from, to), d = (p - from - t * (to - from)).squaredNorm();
    if (!(d <= best) || (d == best && found >= 0)) continue;
    best = d;
    found = h;
    fraction = t;
  }
  return found;
}

FacePoint VertexPlacing::nearest_on_boundary(const Vec3& p, double most, int loop) const {
  double t = 0;
  const int h = nearest_edge(p, most, loop, t);
  if (h < 0) return {};
  const Vec3 from = curves_.points()[curves_.mesh().from(h)];
  return {h / 3, from + t * (curves_.points()[curves_.mesh().to(h)] - from)};
}

int VertexPlacing::on_boundary(const Vec3& place, int loop) {
  const EditMesh& mesh = curves_.mesh();
  double t = 0;
  const int h = nearest_edge(place, std::numeric_limits<double>::infinity(), loop, t);
  if (h < 0) throw Error(ErrorCode::InvalidInput, "a surface without boundary has no place for a node on it");
  int v = -1;
  if (t < kAtVertex && !taken(mesh.from(h))) v = mesh.from(h);
  if (t > 1 - kAtVertex && !taken(mesh.to(h))) v = mesh.to(h);
  if (v < 0) {
    v = curves_.split_edge(h, std::clamp(t, kAtVertex, 1 - kAtVertex));
    const int old = mesh.edge[h];
    const int of = std::find_if(boundary_.begin(), boundary_.end(), [&](const BoundaryEdge& e) { return e.edge == old; })->loop;
    boundary_.push_back({mesh.edge[mesh.out[v]], of});
  }
  take(v);
  return v;
}

}  // namespace hybrid_mesh
