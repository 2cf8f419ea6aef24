// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/curve_network.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <numbers>

namespace hybrid_mesh {
namespace {

// Where a curve crosses an edge of the mesh. Edges are oriented from their smaller to their larger vertex: t in (0, 1) runs that way, and
// next_left says whether the curve goes on to the left of it.
struct Crossing {
  int curve = -1, previous = -1, next = -1;
  int edge = -1, low = -1, high = -1;
  double t = 0.5;
  bool next_left = false;
};

class CurveNetwork {
 public:
  CurveNetwork(const TriangleSurface& surface, EditMesh& mesh, const QuadLayout& layout)
      : surface_(surface), points_(surface.points), mesh_(mesh), layout_(layout), on_edge_(mesh.edge_count), along_edge_(mesh.edge_count, -1) {
    first_.assign(layout.curves.size(), -1);
    last_.assign(layout.curves.size(), -1);
    for (std::size_t c = 0; c < layout.curves.size(); ++c)
      if (layout.curves[c].edge >= 0) along_edge_[layout.curves[c].edge] = static_cast<int>(c);
  }

  // Lays the curves on straight segments in the plane, where the mesh's vertices lie at `uv`.
  void draw(const std::vector<Vec2>& uv);

  void undo(const MeshEdit& edit) {
    if (edit.kind == MeshEdit::Kind::Collapse)
      undo_collapse(edit.half_edge);
    else
      undo_flip(edit.half_edge);
  }

  PatchedSurface cut();

 private:
  struct Station {
    int corner = -1;    // index in the ring, or -1
    int crossing = -1;  // or a crossing on the ring's edge
    double angle = 0, radius = 0;
  };
  struct Chord {
    int curve;
    int from, to;                  // stations, in the curve's direction
    int from_crossing, to_crossing;  // -1: the curve's end
    int low = 0, span = 0;         // the arc that the new vertex does not see: stations low .. low + span
    bool forward = true;           // the arc runs from `from` to `to`
  };

  // --- links of the curves ---------------------------------------------------------------------------------------------------
  void erase_from_curve(int n) {
    const Crossing& x = crossings_[n];
    (x.previous >= 0 ? crossings_[x.previous].next : first_[x.curve]) = x.next;
    (x.next >= 0 ? crossings_[x.next].previous : last_[x.curve]) = x.previous;
    crossings_[n].curve = -1;
    free_.push_back(n);
  }
  bool is_linked(int n) const { return crossings_[n].curve >= 0; }
  void erase(int n) {
    std::vector<int>& list = on_edge_[crossings_[n].edge];
    list.erase(std::find(list.begin(), list.end(), n));
    erase_from_curve(n);
  }
  int new_crossing() {
    if (!free_.empty()) {
      const int n = free_.back();
      free_.pop_back();
      crossings_[n] = Crossing();
      return n;
    }
    crossings_.emplace_back();
    return static_cast<int>(crossings_.size()) - 1;
  }
  // Inserts crossing n after `previous` (-1: at the start).
  void link_after(int curve, int previous, int n) {
    const int next = previous >= 0 ? crossings_[previous].next : first_[curve];
    crossings_[n].previous = previous;
    crossings_[n].next = next;
    (previous >= 0 ? crossings_[previous].next : first_[curve]) = n;
    (next >= 0 ? crossings_[next].previous : last_[curve]) = n;
  }
  // Shortens the curve at the link that follows `p` (-1: its start) as long as it leaves and re-enters an edge, runs beside a corner or along an edge.
  void simplify(int curve, int p) {
    for (;;) {
      const int q = p >= 0 ? crossings_[p].next : first_[curve];
      const int start = layout_.curves[curve].start, end = layout_.curves[curve].end;
      if (p < 0 && q < 0) {
        int h = mesh_.find(start, end);
        if (h < 0) h = mesh_.find(end, start);
        if (h < 0) throw Error(ErrorCode::Internal, "a base curve without crossings joins vertices that are not adjacent");
        along_edge_[mesh_.edge[h]] = curve;
        return;
      }
      const auto touches = [&](int n, int v) { return crossings_[n].low == v || crossings_[n].high == v; };
      if (p < 0 && touches(q, start)) {
        erase(q);
      } else if (p >= 0 && q < 0 && touches(p, end)) {
        const int before = crossings_[p].previous;
        erase(p);
        p = before;
      } else if (p >= 0 && q >= 0 && crossings_[p].edge == crossings_[q].edge) {
        const int before = crossings_[p].previous;
        erase(q);
        erase(p);
        p = before;
      } else {
        return;
      }
    }
  }

  // Takes all curves off an edge that is about to vanish; curves left without crossings go to `bare_`.
  void clear_edge(int e) {
    for (const int n : on_edge_[e]) {
      const int c = crossings_[n].curve;
      erase_from_curve(n);
      if (first_[c] < 0) bare_.push_back(c);
    }
    on_edge_[e].clear();
    if (along_edge_[e] >= 0) {
      bare_.push_back(along_edge_[e]);
      along_edge_[e] = -1;
    }
  }

  // The chords of a polygon whose boundary edges are the half-edges `sides_` (interior on the left), with `ring_` their starts; open: the last ring vertex has
  // no side.
  void collect(bool closed) {
    stations_.clear();
    chords_.clear();
    corner_station_.assign(ring_.size(), -1);
    if (station_of_.size() < crossings_.size()) station_of_.resize(crossings_.size() + 64, -1);
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      corner_station_[i] = static_cast<int>(stations_.size());
      stations_.push_back({static_cast<int>(i), -1, 0, 0});
      if (!closed && i + 1 == ring_.size()) break;
      const std::vector<int>& list = on_edge_[mesh_.edge[sides_[i]]];
      const bool up = mesh_.from(sides_[i]) < mesh_.to(sides_[i]);
      for (std::size_t k = 0; k < list.size(); ++k) {
        const int n = up ? list[k] : list[list.size() - 1 - k];
        station_of_[n] = static_cast<int>(stations_.size());
        stations_.push_back({-1, n, 0, 0});
      }
    }
    const auto corner_of = [&](int v) {
      for (std::size_t i = 0; i < ring_.size(); ++i)
        if (ring_[i] == v) return corner_station_[i];
      throw Error(ErrorCode::Internal, "a base curve ends outside the star that it runs through");
    };
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const bool up = mesh_.from(sides_[i]) < mesh_.to(sides_[i]);
      for (const int n : on_edge_[mesh_.edge[sides_[i]]]) {
        const Crossing& x = crossings_[n];
        const QuadLayout::Curve& curve = layout_.curves[x.curve];
        if (x.next_left == up) {
          const int to = x.next >= 0 ? station_of_[x.next] : corner_of(curve.end);
          chords_.push_back({x.curve, station_of_[n], to, n, x.next});
        } else if (x.previous < 0) {
          chords_.push_back({x.curve, corner_of(curve.start), station_of_[n], -1, n});
        }
      }
    }
    for (const int c : bare_)
      if (first_[c] < 0) chords_.push_back({c, corner_of(layout_.curves[c].start), corner_of(layout_.curves[c].end), -1, -1});
    bare_.clear();
  }

  Vec3 position(const Crossing& x) const { return points_[x.low] + x.t * (points_[x.high] - points_[x.low]); }

  int place(const Chord& chord, int previous, int edge, int a, int b, double t_from_a, bool next_left_of_ab) {
    const int n = new_crossing();
    Crossing& x = crossings_[n];
    x.curve = chord.curve;
    x.edge = edge;
    x.low = std::min(a, b);
    x.high = std::max(a, b);
    x.t = a < b ? t_from_a : 1 - t_from_a;
    x.next_left = (a < b) == next_left_of_ab;
    link_after(chord.curve, previous, n);
    return n;
  }

  // Parameters along an edge must be strictly increasing: kept where they are, spread evenly where not.
  static void spread(std::vector<double>& t) {
    bool good = true;
    double last = 0;
    for (const double x : t) {
      if (!(x > last + 1e-4)) good = false;
      last = x;
    }
    if (good && last < 1 - 1e-4) return;
    for (std::size_t i = 0; i < t.size(); ++i) t[i] = (i + 1.0) / (t.size() + 1.0);
  }

  // Shortens at both ends of every chord; links between new crossings need it never.
  void simplify_chords() {
    for (const Chord& c : chords_) {
      if (c.from_crossing < 0 || is_linked(c.from_crossing)) simplify(c.curve, c.from_crossing);
      if (first_[c.curve] < 0) continue;
      if (c.to_crossing < 0) simplify(c.curve, last_[c.curve]);
      else if (is_linked(c.to_crossing)) simplify(c.curve, crossings_[c.to_crossing].previous);
    }
  }

  void undo_collapse(int h);
  void undo_flip(int h);
  void insert_vertex(int v, bool closed);

  static int split_boundary_edge(PatchedSurface& out, int h);

  const TriangleSurface& surface_;
  const std::vector<Vec3>& points_;
  EditMesh& mesh_;
  const QuadLayout& layout_;
  std::vector<Crossing> crossings_;
  std::vector<int> free_;
  std::vector<std::vector<int>> on_edge_;  // per edge name: its crossings from the smaller vertex to the larger
  std::vector<int> along_edge_;            // per edge name: the curve that is this edge
  std::vector<int> first_, last_;          // per curve: crossings, -1: none
  std::vector<int> bare_, ring_, sides_, spokes_, corner_station_, station_of_;
  std::vector<Station> stations_;
  std::vector<Chord> chords_;
  std::vector<std::pair<int, int>> split_boundary_chain_;  // quad and first of the two sides that share a boundary edge of the mesh
};

void CurveNetwork::undo_collapse(int h) {
  mesh_.undo_collapse(h);
  const int v = mesh_.from(h);
  // The star of v from u = to(h) on. Its spokes but those to u and to the two apexes had the same names when they started at u: those edges vanish.
  const bool closed = !mesh_.is_boundary(v);
  ring_.clear(), sides_.clear(), spokes_.clear();
  int g = h;
  do {
    spokes_.push_back(g);
    ring_.push_back(mesh_.to(g));
    sides_.push_back(EditMesh::next(g));
    const int n = mesh_.ccw(g);
    if (n < 0) {
      ring_.push_back(mesh_.apex(g));
      break;
    }
    g = n;
  } while (g != h);
  const int last = static_cast<int>(spokes_.size()) - (closed ? 2 : 1);
  for (int i = 2; i <= last; ++i) clear_edge(mesh_.edge[spokes_[i]]);
  collect(closed);
  if (!chords_.empty()) insert_vertex(v, closed);
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
      if (x.corner >= spoke_count) throw Error(ErrorCode::Internal, "a base curve crosses the boundary");
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

// Where segment (a, b) crosses edge (p, q), as the fraction from p on: exactly, for comparisons.
boost::multiprecision::cpp_rational exact_crossing(const Vec2& a, const Vec2& b, const Vec2& p, const Vec2& q) {
  using Rational = boost::multiprecision::cpp_rational;
  const Rational dx = Rational(b.x()) - Rational(a.x()), dy = Rational(b.y()) - Rational(a.y());
  const auto side = [&](const Vec2& x) { return Rational(dx * (Rational(x.y()) - Rational(a.y())) - dy * (Rational(x.x()) - Rational(a.x()))); };
  const Rational sp = side(p), sq = side(q);
  return sp / (sp - sq);
}

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
      if (h < 0 || h == mesh_.out[a]) throw Error(ErrorCode::Internal, "a segment of a layout leaves its disk");
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
      if (o < 0) throw Error(ErrorCode::Internal, "a segment of a layout leaves its disk");
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

// Splits a convex polygon with corners on the sides of one triangle into triangles none of which lies along one side.
class PolygonSplitter {
 public:
  struct Corner {
    int point;    // index of the point
    int mark;     // of the polygon's edge to the next corner
    Vec2 at;      // in a reference triangle
    int sides;    // bit set of the triangle's sides that hold it
  };
  template <class Emit>
  static void split(std::vector<Corner> polygon, const Emit& emit) {
    while (polygon.size() > 3) {
      const int n = static_cast<int>(polygon.size());
      int best = -1;
      double best_quality = -1;
      for (int i = 0; i < n; ++i) {
        const Corner &a = polygon[(i + n - 1) % n], &b = polygon[i], &c = polygon[(i + 1) % n];
        if (a.sides & b.sides & c.sides) continue;
        int rest = ~0;
        for (int j = 0; j < n; ++j)
          if (j != i) rest &= polygon[j].sides;
        if (rest) continue;
        const Vec2 ab = b.at - a.at, bc = c.at - b.at, ca = a.at - c.at;
        const double area = ab.x() * bc.y() - ab.y() * bc.x();
        const double quality = area / (ab.squaredNorm() + bc.squaredNorm() + ca.squaredNorm());
        if (quality > best_quality) best_quality = quality, best = i;
      }
      if (best < 0) throw Error(ErrorCode::Internal, "a piece of a triangle lies along one of its sides");
      const int p = (best + n - 1) % n, q = (best + 1) % n;
      emit(polygon[p], polygon[best], polygon[q], polygon[p].mark, polygon[best].mark, -1);
      polygon[p].mark = -1;
      polygon.erase(polygon.begin() + best);
    }
    if (polygon[0].sides & polygon[1].sides & polygon[2].sides) throw Error(ErrorCode::Internal, "a piece of a triangle lies along one of its sides");
    emit(polygon[0], polygon[1], polygon[2], polygon[0].mark, polygon[1].mark, polygon[2].mark);
  }
};

PatchedSurface CurveNetwork::cut() {
  PatchedSurface out;
  TriangleSurface& fine = out.mesh;
  fine.points = points_;
  for (std::size_t v = 0; v < points_.size(); ++v) out.source.push_back({{static_cast<int>(v), -1, -1}, {1, 0, 0}});
  std::vector<int> point_of(crossings_.size(), -1);
  for (std::size_t c = 0; c < first_.size(); ++c)
    for (int n = first_[c]; n >= 0; n = crossings_[n].next) {
      point_of[n] = static_cast<int>(fine.points.size());
      fine.points.push_back(position(crossings_[n]));
      out.source.push_back({{crossings_[n].low, crossings_[n].high, -1}, {1 - crossings_[n].t, crossings_[n].t, 0}});
    }
  const Vec2 reference[3] = {Vec2(0, 0), Vec2(1, 0), Vec2(0.5, std::sqrt(0.75))};
  std::vector<int> marks;  // per half-edge of the result: the curve along it, -1 none
  for (int f = 0; f < static_cast<int>(surface_.faces.size()); ++f) {
    ring_.clear(), sides_.clear();
    for (int i = 0; i < 3; ++i) {
      ring_.push_back(mesh_.from(3 * f + i));
      sides_.push_back(3 * f + i);
    }
    collect(true);
    // Where each station lies in the reference triangle, and on which of its sides.
    std::vector<PolygonSplitter::Corner> polygon;
    int corner = 0;
    for (const Station& s : stations_) {
      PolygonSplitter::Corner c{};
      std::array<double, 3> w{0, 0, 0};
      if (s.corner >= 0) {
        corner = s.corner;
        c.point = ring_[corner];
        w[corner] = 1;
        c.sides = (1 << corner) | (1 << ((corner + 2) % 3));
        c.mark = along_edge_[mesh_.edge[sides_[corner]]];
      } else {
        const Crossing& x = crossings_[s.crossing];
        c.point = point_of[s.crossing];
        const double t = ring_[corner] == x.low ? x.t : 1 - x.t;
        w[corner] = 1 - t;
        w[(corner + 1) % 3] = t;
        c.sides = 1 << corner;
        c.mark = -1;
      }
      c.at = w[0] * reference[0] + w[1] * reference[1] + w[2] * reference[2];
      polygon.push_back(c);
    }
    const auto emit = [&](const PolygonSplitter::Corner& a, const PolygonSplitter::Corner& b, const PolygonSplitter::Corner& c, int ab, int bc, int ca) {
      fine.faces.push_back({a.point, b.point, c.point});
      fine.source_face.push_back(f);
      marks.insert(marks.end(), {ab, bc, ca});
    };
    // Cut off the shortest arc first: what lies below it holds no other chord.
    std::vector<std::pair<int, int>> cuts;
    std::vector<int> cut_curve;
    for (const Chord& c : chords_) {
      cuts.push_back({std::min(c.from, c.to), std::max(c.from, c.to)});
      cut_curve.push_back(c.curve);
    }
    std::vector<int> order(cuts.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return std::pair(cuts[a].second - cuts[a].first, a) < std::pair(cuts[b].second - cuts[b].first, b); });
    std::vector<int> left(polygon.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = static_cast<int>(i);
    for (const int i : order) {
      const auto low = std::find(left.begin(), left.end(), cuts[i].first), high = std::find(left.begin(), left.end(), cuts[i].second);
      std::vector<PolygonSplitter::Corner> piece;
      for (auto it = low; it != high + 1; ++it) piece.push_back(polygon[*it]);
      if (piece.size() < 3) throw Error(ErrorCode::Internal, "a base curve runs along a side of a triangle");
      piece.back().mark = cut_curve[i];
      polygon[*low].mark = cut_curve[i];
      PolygonSplitter::split(piece, emit);
      left.erase(low + 1, high);
    }
    std::vector<PolygonSplitter::Corner> rest;
    for (const int i : left) rest.push_back(polygon[i]);
    PolygonSplitter::split(rest, emit);
  }
  connect_half_edges(fine);

  // Patches: flood fill between the curves; each curve knows the quad on its left and right.
  const int quads = static_cast<int>(layout_.quads.size());
  std::vector<std::array<PatchSide, 2>> beside(layout_.curves.size());  // [0]: left of the curve
  for (int q = 0; q < quads; ++q)
    for (int i = 0; i < 4; ++i) {
      const QuadLayout::Side& s = layout_.quads[q].sides[i];
      if (s.curve >= 0) beside[s.curve][s.forward ? 0 : 1] = {q, i};
    }
  // A half-edge along a curve runs with it if it leads from an earlier to a later point.
  std::vector<std::vector<int>> chains(layout_.curves.size());
  std::vector<int> rank(fine.points.size(), 0);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    chains[c].push_back(layout_.curves[c].start);
    for (int n = first_[c]; n >= 0; n = crossings_[n].next) {
      rank[point_of[n]] = static_cast<int>(chains[c].size());
      chains[c].push_back(point_of[n]);
    }
    chains[c].push_back(layout_.curves[c].end);
  }
  const auto rank_on = [&](int c, int point) {
    if (point == layout_.curves[c].start) return -1;
    if (point == layout_.curves[c].end) return static_cast<int>(chains[c].size());
    return rank[point];
  };
  std::vector<std::array<std::vector<int>, 4>> sides(quads);
  // Boundary sides: from a node's vertex along the boundary to the next node.
  std::vector<char> is_node(points_.size(), 0);
  std::vector<int> vertex_of_node = layout_.node_vertex;
  for (const int v : layout_.node_vertex)
    if (v >= 0) is_node[v] = 1;
  std::vector<int> boundary_from(fine.points.size(), -1);
  for (int h = 0; h < static_cast<int>(fine.opposite.size()); ++h)
    if (fine.opposite[h] < 0) boundary_from[fine.from(h)] = h;
  std::vector<std::pair<int, int>> seeds;  // face, quad: for quads that are reached by no curve
  for (int q = 0; q < quads; ++q) {
    const QuadLayout::Quad& quad = layout_.quads[q];
    for (int i = 0; i < 4; ++i) {
      if (quad.sides[i].curve >= 0) {
        sides[q][i] = chains[quad.sides[i].curve];
        if (!quad.sides[i].forward) std::reverse(sides[q][i].begin(), sides[q][i].end());
        continue;
      }
      if (layout_.node_vertex[quad.nodes[i]] < 0) continue;  // the second half of a split boundary edge, done with the first
      std::vector<int> chain{layout_.node_vertex[quad.nodes[i]]};
      seeds.push_back({boundary_from[chain[0]] / 3, q});
      do {
        chain.push_back(fine.to(boundary_from[chain.back()]));
      } while (!is_node[chain.back()]);
      const int next = (i + 1) % 4;
      if (layout_.node_vertex[quad.nodes[next]] >= 0) {
        sides[q][i] = chain;
      } else {
        split_boundary_chain_.push_back({q, i});
        sides[q][i] = chain;
      }
    }
  }
  out.patch.assign(fine.faces.size(), -1);
  std::vector<int> stack;
  const auto seed = [&](int face, int q) {
    if (out.patch[face] >= 0 && out.patch[face] != q) throw Error(ErrorCode::Internal, "two base quads claim one patch");
    if (out.patch[face] == q) return;
    out.patch[face] = q;
    stack.push_back(face);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h = 3 * f; h < 3 * f + 3; ++h) {
        const int o = fine.opposite[h];
        if (o < 0 || marks[h] >= 0) continue;
        if (out.patch[o / 3] < 0) {
          out.patch[o / 3] = q;
          stack.push_back(o / 3);
        } else if (out.patch[o / 3] != q) {
          throw Error(ErrorCode::Internal, "two base quads claim one patch");
        }
      }
    }
  };
  for (int h = 0; h < static_cast<int>(fine.opposite.size()); ++h) {
    const int c = marks[h];
    if (c < 0) continue;
    const bool with = rank_on(c, fine.from(h)) < rank_on(c, fine.to(h));
    const PatchSide side = beside[c][with ? 0 : 1];
    if (side.patch < 0) throw Error(ErrorCode::Internal, "a base curve borders no quad");
    seed(h / 3, side.patch);
  }
  for (const auto& [face, q] : seeds) seed(face, q);
  for (const int p : out.patch)
    if (p < 0) throw Error(ErrorCode::Internal, "a part of the surface belongs to no base quad");

  // Nodes inside boundary edges: the boundary point nearest to the middle; an edge without inner points is split.
  for (const auto& [q, i] : split_boundary_chain_) {
    std::vector<int> chain = sides[q][i];
    if (chain.size() == 2) {
      chain.insert(chain.begin() + 1, split_boundary_edge(out, boundary_from[chain[0]]));
    }
    double length = 0;
    std::vector<double> at{0};
    for (std::size_t k = 1; k < chain.size(); ++k) at.push_back(length += (fine.points[chain[k]] - fine.points[chain[k - 1]]).norm());
    std::size_t best = 1;
    for (std::size_t k = 1; k + 1 < chain.size(); ++k)
      if (std::abs(at[k] - length / 2) < std::abs(at[best] - length / 2)) best = k;
    sides[q][i].assign(chain.begin(), chain.begin() + best + 1);
    sides[q][(i + 1) % 4].assign(chain.begin() + best, chain.end());
  }
  if (!split_boundary_chain_.empty()) connect_half_edges(fine);

  out.nodes.resize(quads);
  out.neighbours.resize(quads);
  out.sides = std::move(sides);
  out.node_count = static_cast<int>(layout_.node_vertex.size());
  for (int q = 0; q < quads; ++q) {
    out.nodes[q] = layout_.quads[q].nodes;
    for (int i = 0; i < 4; ++i) {
      const QuadLayout::Side& s = layout_.quads[q].sides[i];
      if (s.curve >= 0) out.neighbours[q][i] = beside[s.curve][s.forward ? 1 : 0];
    }
  }
  return out;
}

// Splits the face at boundary half-edge h by a point in the edge's middle and returns that point; adjacency is left to the caller.
int CurveNetwork::split_boundary_edge(PatchedSurface& out, int h) {
  TriangleSurface& fine = out.mesh;
  const int f = h / 3, i = h % 3, j = (i + 1) % 3;
  const int a = fine.faces[f][i], b = fine.faces[f][j];
  const int m = static_cast<int>(fine.points.size());
  fine.points.push_back(0.5 * (fine.points[a] + fine.points[b]));
  const PointSource middle = middle_of(out.source[a], out.source[b]);
  out.source.push_back(middle);
  std::array<int, 3> second = fine.faces[f];
  fine.faces[f][j] = m;
  second[i] = m;
  fine.faces.push_back(second);
  fine.source_face.push_back(fine.source_face[f]);
  out.patch.push_back(out.patch[f]);
  return m;
}

}  // namespace

PatchedSurface cut_along_layout(const TriangleSurface& surface, EditMesh& mesh, const std::vector<MeshEdit>& log, const QuadLayout& layout, const Progress& progress) {
  CurveNetwork network(surface, mesh, layout);
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
  CurveNetwork network(disk, mesh, layout);
  network.draw(uv);
  return network.cut();
}

}  // namespace hybrid_mesh
