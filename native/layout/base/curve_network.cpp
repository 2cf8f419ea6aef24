// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/curve_network.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <numbers>

#include "layout/base/curves_on_mesh.h"

namespace hybrid_mesh {

void CurveNetwork::undo_collapse(int h) {
  mesh_.undo_collapse(h);
  const int v = mesh_.from(h);
  if (!features_.is_on_curve(v)) {
    put_back(h, h, !mesh_.is_boundary(v), h);
    return;
  }
  // No curve crosses a feature: what is on either side of it is by itself, as at a boundary.
  const std::vector<int> along = features_.along(mesh_, v);
  const int other = along[0] == h ? along[1] : along[0];
  put_back(h, other, false, h);
  put_back(other, h, false, h);
}

// Draws the curves anew in the star of a vertex that has come back, or in the part of it between two half-edges. `kept` leads to where it was.
void CurveNetwork::put_back(int first, int last, bool closed, int kept) {
  const int v = mesh_.from(first);
  ring_.clear(), sides_.clear(), spokes_.clear();
  int g = first;
  do {
    spokes_.push_back(g);
    ring_.push_back(mesh_.to(g));
    sides_.push_back(EditMesh::next(g));
    const int n = mesh_.ccw(g);
    if (n < 0 || (n == last && !closed)) {
      ring_.push_back(mesh_.apex(g));
      break;
    }
    g = n;
  } while (g != last);
  // Its edges but those to `kept` and to the two apexes had the same names when they started at to(kept): those edges vanish.
  const int apex = mesh_.apex(kept), other_apex = mesh_.opposite[kept] >= 0 ? mesh_.apex(mesh_.opposite[kept]) : -1;
  for (const int s : spokes_)
    if (s != kept && mesh_.to(s) != apex && mesh_.to(s) != other_apex && !features_.on(mesh_, s)) clear_edge(mesh_.edge[s]);
  collect(closed);
  if (!chords_.empty()) insert_vertex(v, closed);
}

// The points of a layout's curve that runs along a feature.
std::vector<int> CurveNetwork::follow_feature(int c, const std::vector<char>& is_node) {
  const int name = layout_.curves[c].edge;
  const int h = static_cast<int>(std::find(mesh_.edge.begin(), mesh_.edge.end(), name) - mesh_.edge.begin());
  std::vector<int> chain;
  for (const int start : {h, mesh_.opposite[h]}) {
    int g = start;
    along_edge_[mesh_.edge[g]] = c;
    std::vector<int> half{mesh_.to(g)};
    while (!is_node[half.back()]) {
      const std::vector<int> along = features_.along(mesh_, half.back());
      g = mesh_.edge[along[0]] == mesh_.edge[g] ? along[1] : along[0];
      along_edge_[mesh_.edge[g]] = c;
      half.push_back(mesh_.to(g));
    }
    std::reverse(chain.begin(), chain.end());
    chain.insert(chain.end(), half.begin(), half.end());
  }
  if (chain.front() != layout_.curves[c].start) std::reverse(chain.begin(), chain.end());
  return chain;
}

void CurveNetwork::insert_vertex(int v, bool closed) {
  const int k = static_cast<int>(ring_.size());
  const int count = static_cast<int>(stations_.size());
  // Polar positions around v, the angles scaled so that they close.
  std::vector<double> angle(k + 1, 0.0);
  const Vec3& center = points_[v];
  for (int i = 0; i < (closed ? k : k - 1); ++i) {
    const Vec3 a = points_[ring_[i]] - center, b = points_[ring_[(i + 1) % k]] - center;
    angle[i + 1] = angle[i] + std::max(std::atan2(a.cross(b).norm(), a.dot(b)), 1e-3);
  }
  const double total = closed ? angle[k] : angle[k - 1];
  const double scale = closed ? 2 * std::numbers::pi / total : std::min(1.0, 0.9 * std::numbers::pi / total);
  for (double& x : angle) x *= scale;
  int corner = 0;
  for (Station& s : stations_) {
    if (s.corner >= 0) {
      corner = s.corner;
      s.angle = angle[corner];
      s.radius = (points_[ring_[corner]] - center).norm();
    } else {
      const Crossing& x = crossings_[s.crossing];
      const double t = ring_[corner] == x.low ? x.t : 1 - x.t;
      s.angle = angle[corner] + t * (angle[corner + 1] - angle[corner]);
      s.radius = (position(x) - center).norm();
    }
  }
  for (Chord& c : chords_) {
    const int lower = std::min(c.from, c.to), upper = std::max(c.from, c.to);
    const double inner = stations_[upper].angle - stations_[lower].angle;
    // The arc between the two ends on the far side of v: at most half a turn; what is left over by a tie goes to the lower one.
    if (!closed || inner <= std::numbers::pi) {
      c.low = lower, c.span = upper - lower;
      c.forward = c.from == lower;
    } else {
      c.low = upper, c.span = count - (upper - lower);
      c.forward = c.from == upper;
    }
  }
  // The crossings of each spoke, from v outwards: the larger arc first.
  struct Hit {
    int chord, span;
    double t;
    int crossing;
  };
  std::vector<std::vector<Hit>> hits(k);
  const int spoke_count = static_cast<int>(spokes_.size());
  for (int ci = 0; ci < static_cast<int>(chords_.size()); ++ci) {
    const Chord& c = chords_[ci];
    const Station& a = stations_[c.low];
    const Station& b = stations_[(c.low + c.span) % count];
    double arc = b.angle - a.angle;
    if (arc < 0) arc += 2 * std::numbers::pi;
    for (int s = 1; s < c.span; ++s) {
      const Station& x = stations_[(c.low + s) % count];
      if (x.corner < 0) continue;
      double along = x.angle - a.angle;
      if (along < 0) along += 2 * std::numbers::pi;
      const double denominator = a.radius * std::sin(along) + b.radius * std::sin(arc - along);
      double t = denominator > 0 && x.radius > 0 ? a.radius * b.radius * std::sin(arc) / denominator / x.radius : 0.5;
      if (!(t > 0.02)) t = 0.02;
      hits[x.corner].push_back({ci, c.span, std::min(t, 0.98), -1});
    }
  }
  std::vector<double> parameters;
  for (int i = 0; i < k; ++i) {
    if (hits[i].empty()) continue;
    std::sort(hits[i].begin(), hits[i].end(), [](const Hit& a, const Hit& b) { return a.span != b.span ? a.span > b.span : a.chord < b.chord; });
    parameters.clear();
    for (const Hit& x : hits[i]) parameters.push_back(x.t);
    spread(parameters);
    for (std::size_t j = 0; j < hits[i].size(); ++j) hits[i][j].t = parameters[j];
  }
  // Create the crossings chord by chord, in the curve's direction.
  for (int ci = 0; ci < static_cast<int>(chords_.size()); ++ci) {
    const Chord& c = chords_[ci];
    int previous = c.from_crossing;
    for (int s = 1; s < c.span; ++s) {
      const int at = c.forward ? c.low + s : c.low + c.span - s;
      const Station& x = stations_[at % count];
      if (x.corner < 0) continue;
      if (x.corner >= spoke_count) throw NoMap("a base curve crosses the boundary");
      for (Hit& hit : hits[x.corner])
        if (hit.chord == ci) {
          previous = hit.crossing = place(c, previous, mesh_.edge[spokes_[x.corner]], v, ring_[x.corner], hit.t, c.forward);
          break;
        }
    }
  }
  for (int i = 0; i < k; ++i) {
    if (hits[i].empty()) continue;
    std::vector<int>& list = on_edge_[mesh_.edge[spokes_[i]]];
    for (const Hit& x : hits[i]) list.push_back(x.crossing);
    if (v > ring_[i]) std::reverse(list.begin(), list.end());
  }
  simplify_chords();
}

void CurveNetwork::undo_flip(int h) {
  clear_edge(mesh_.edge[h]);
  mesh_.undo_flip(h);
  const int o = mesh_.opposite[h];
  const int a = mesh_.from(h), b = mesh_.to(h);
  ring_ = {a, mesh_.apex(o), b, mesh_.apex(h)};
  sides_ = {EditMesh::next(o), EditMesh::prev(o), EditMesh::next(h), EditMesh::prev(h)};
  collect(true);
  if (chords_.empty()) return;
  const int middle = corner_station_[2];
  // Chords with one end on the right of a -> b (stations below `middle`) and one on its left cross the edge, in the order of their right ends.
  struct Hit {
    int chord, right, left;
  };
  std::vector<Hit> hits;
  for (int ci = 0; ci < static_cast<int>(chords_.size()); ++ci) {
    const int lower = std::min(chords_[ci].from, chords_[ci].to), upper = std::max(chords_[ci].from, chords_[ci].to);
    if (lower > 0 && lower < middle && upper > middle) hits.push_back({ci, lower, upper});
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& x, const Hit& y) { return x.right != y.right ? x.right < y.right : x.left > y.left; });
  std::vector<int>& list = on_edge_[mesh_.edge[h]];
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Chord& c = chords_[hits[i].chord];
    list.push_back(place(c, c.from_crossing, mesh_.edge[h], a, b, (i + 1.0) / (hits.size() + 1.0), c.from == hits[i].right));
  }
  if (a > b) std::reverse(list.begin(), list.end());
  simplify_chords();
}

namespace {

// Where segment (a, b) crosses edge (p, q), as the fraction from p on: exactly, for comparisons.
boost::multiprecision::cpp_rational exact_crossing(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  using Rational = boost::multiprecision::cpp_rational;
  const Rational dx = Rational(b.x()) - Rational(a.x()), dy = Rational(b.y()) - Rational(a.y());
  const auto side = [&](const Vec2& x) { return Rational(dx * (Rational(x.y()) - Rational(a.y())) - dy * (Rational(x.x()) - Rational(a.x()))); };
  const Rational sp = side(p), sq = side(q);
  return sp / (sp - sq);
}

}  // namespace

void CurveNetwork::draw(const std::vector<Vec2>& uv) {
  const auto point = [&](int v) { return CGAL::Exact_predicates_inexact_constructions_kernel::Point_2(uv[v].x(), uv[v].y()); };
  for (int c = 0; c < static_cast<int>(layout_.curves.size()); ++c) {
    const int a = layout_.curves[c].start, b = layout_.curves[c].end;
    int direct = mesh_.find(a, b);
    if (direct < 0) direct = mesh_.find(b, a);
    if (direct >= 0) {
      along_edge_[mesh_.edge[direct]] = c;
      continue;
    }
    // A vertex on the segment counts as left of it, for this segment throughout.
    const auto is_right = [&](int v) { return CGAL::orientation(point(a), point(b), point(v)) == CGAL::RIGHT_TURN; };
    int h = mesh_.out[a];
    while (!(is_right(mesh_.to(h)) && !is_right(mesh_.apex(h)))) {
      h = mesh_.ccw(h);
      if (h < 0 || h == mesh_.out[a]) throw NoMap("a segment of a layout leaves its disk");
    }
    int edge = EditMesh::next(h), previous = -1;  // from its right end to its left one
    for (;;) {
      const int p = mesh_.from(edge), q = mesh_.to(edge);
      const Vec2 d = uv[b] - uv[a], x = uv[p] - uv[a], y = uv[q] - uv[a];
      const double sp = d.x() * x.y() - d.y() * x.x(), sq = d.x() * y.y() - d.y() * y.x();
      const double t = sq > sp ? std::clamp(sp / (sp - sq), 0.0, 1.0) : 0.5;
      previous = place({c, 0, 0, -1, -1}, previous, mesh_.edge[edge], p, q, t, false);
      on_edge_[mesh_.edge[edge]].push_back(previous);
      const int o = mesh_.opposite[edge];
      if (o < 0) throw NoMap("a segment of a layout leaves its disk");
      const int apex = mesh_.apex(o);
      if (apex == b) break;
      edge = is_right(apex) ? EditMesh::prev(o) : EditMesh::next(o);
    }
  }
  std::vector<double> parameters;
  for (std::vector<int>& list : on_edge_) {
    if (list.empty()) continue;
    std::sort(list.begin(), list.end(), [&](int i, int j) {
      const Crossing &x = crossings_[i], &y = crossings_[j];
      if (std::abs(x.t - y.t) > 1e-9) return x.t < y.t;
      const auto exact = [&](const Crossing& z) {
        return exact_crossing(uv[layout_.curves[z.curve].start], uv[layout_.curves[z.curve].end], uv[z.low], uv[z.high]);
      };
      return exact(x) < exact(y);
    });
    parameters.clear();
    for (const int n : list) parameters.push_back(std::clamp(crossings_[n].t, 0.02, 0.98));
    spread(parameters);
    for (std::size_t k = 0; k < list.size(); ++k) crossings_[list[k]].t = parameters[k];
  }
}

PatchedSurface cut_along_layout(const TriangleSurface& surface, EditMesh& mesh, const MeshFeatures& features, const std::vector<MeshEdit>& log,
                                const QuadLayout& layout, const Progress& progress) {
  CurveNetwork network(surface, mesh, features, layout);
  for (std::size_t i = log.size(); i-- > 0;) {
    if (i % 1024 == 0) progress(0.7 * (1 - static_cast<double>(i) / log.size()));
    network.undo(log[i]);
  }
  progress(0.7);
  PatchedSurface result = network.cut();
  progress(1);
  return result;
}

PatchedSurface cut_along_segments(const TriangleSurface& disk, const std::vector<Vec2>& uv, const QuadLayout& layout) {
  EditMesh mesh(disk);
  const MeshFeatures none;
  CurveNetwork network(disk, mesh, none, layout);
  network.draw(uv);
  return network.cut();
}

}  // namespace hybrid_mesh
