// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/surface_curves.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "layout/face_splitting.h"

namespace hybrid_mesh {
namespace {

constexpr double kLeastGap = 1e-3;  // between neighbouring crossings of an edge and its ends, as a fraction of it

double inside(double t) { return std::isfinite(t) ? std::clamp(t, kLeastGap, 1 - kLeastGap) : 0.5; }

// On which side of the line through p and q is x? All in barycentric coordinates.
double turn(const std::array<double, 3>& p, const std::array<double, 3>& q, const std::array<double, 3>& x) {
  return p[0] * (q[1] * x[2] - q[2] * x[1]) - p[1] * (q[0] * x[2] - q[2] * x[0]) + p[2] * (q[0] * x[1] - q[1] * x[0]);
}

// Where the line through p and q meets the segment from a to b, as a fraction of that.
double meeting(const std::array<double, 3>& p, const std::array<double, 3>& q, const std::array<double, 3>& a, const std::array<double, 3>& b) {
  const double at_a = turn(p, q, a), at_b = turn(p, q, b), t = at_a / (at_a - at_b);
  return t > 0 && t < 1 ? inside(t) : 0.5;
}

}  // namespace

SurfaceCurves::SurfaceCurves(const TriangleSurface& surface, std::vector<Vec3> points) : mesh_(surface), points_(std::move(points)) {
  for (int v = 0; v < static_cast<int>(points_.size()); ++v) source_.push_back({{v, -1, -1}, {1, 0, 0}});
  for (int f = 0; f < static_cast<int>(surface.faces.size()); ++f) source_face_.push_back(f);
  half_edge_.resize(mesh_.edge_count);
  for (int h = static_cast<int>(mesh_.edge.size()) - 1; h >= 0; --h) half_edge_[mesh_.edge[h]] = h;
  on_edge_.resize(mesh_.edge_count);
  along_.assign(mesh_.edge_count, -1);
  degree_.assign(points_.size(), 0);
}

std::vector<std::array<int, 3>> SurfaceCurves::faces() const {
  std::vector<std::array<int, 3>> out(face_count());
  for (int f = 0; f < face_count(); ++f) out[f] = {mesh_.from(3 * f), mesh_.from(3 * f + 1), mesh_.from(3 * f + 2)};
  return out;
}

Vec3 SurfaceCurves::position(int n) const {
  const Crossing& x = crossings_[n];
  return points_[low(x.edge)] + x.t * (points_[high(x.edge)] - points_[low(x.edge)]);
}

std::vector<Vec3> SurfaceCurves::polyline(int c) const {
  std::vector<Vec3> out{points_[curves_[c].start]};
  for (int n = curves_[c].first; n >= 0; n = crossings_[n].next) out.push_back(position(n));
  out.push_back(points_[curves_[c].end]);
  return out;
}

double SurfaceCurves::length(int c) const {
  double sum = 0;
  Vec3 at = points_[curves_[c].start];
  for (int n = curves_[c].first; n >= 0; n = crossings_[n].next) {
    const Vec3 next = position(n);
    sum += (next - at).norm();
    at = next;
  }
  return sum + (points_[curves_[c].end] - at).norm();
}

int SurfaceCurves::leaving(int n) const {
  const int h = half_edge_[crossings_[n].edge];
  const bool up = mesh_.from(h) < mesh_.to(h);
  return up == crossings_[n].next_left ? mesh_.opposite[h] : h;
}

std::vector<SurfaceCurves::End> SurfaceCurves::ends_at(int v) const {
  std::vector<End> ends;
  int g = mesh_.out[v];
  do {
    if (const int c = along_[mesh_.edge[g]]; c >= 0) ends.push_back({c, curves_[c].start == v, g, true});
    // Counter-clockwise seen from v, the side across runs from to(g) to apex(g).
    const int s = EditMesh::next(g);
    const std::vector<int>& list = on_edge_[mesh_.edge[s]];
    const bool up = mesh_.from(s) < mesh_.to(s);
    for (std::size_t k = 0; k < list.size(); ++k) {
      const int n = up ? list[k] : list[list.size() - 1 - k];
      const Crossing& x = crossings_[n];
      // One that was led past v and is not simplified yet may end at another corner.
      const bool at_start = x.next_left != up;
      if ((at_start ? x.previous : x.next) < 0 && (at_start ? curves_[x.curve].start : curves_[x.curve].end) == v) ends.push_back({x.curve, at_start, g, false});
    }
    g = mesh_.ccw(g);
  } while (g >= 0 && g != mesh_.out[v]);
  return ends;
}

SurfaceCurves::FacePolygon SurfaceCurves::polygon(int f) const {
  FacePolygon out;
  std::array<int, 3> corner_station{};
  std::vector<std::pair<int, int>> of_crossing;
  for (int i = 0; i < 3; ++i) {
    const int s = 3 * f + i;
    Station corner;
    corner.corner = i;
    corner.weights[i] = 1;
    corner_station[i] = static_cast<int>(out.stations.size());
    out.stations.push_back(corner);
    const std::vector<int>& list = on_edge_[mesh_.edge[s]];
    const bool up = mesh_.from(s) < mesh_.to(s);
    for (std::size_t k = 0; k < list.size(); ++k) {
      Station x;
      x.crossing = up ? list[k] : list[list.size() - 1 - k];
      const double t = up ? crossings_[x.crossing].t : 1 - crossings_[x.crossing].t;
      x.weights[i] = 1 - t;
      x.weights[(i + 1) % 3] = t;
      of_crossing.push_back({x.crossing, static_cast<int>(out.stations.size())});
      out.stations.push_back(x);
    }
  }
  if (of_crossing.empty()) return out;
  std::sort(of_crossing.begin(), of_crossing.end());
  const auto station = [&](int n) { return std::lower_bound(of_crossing.begin(), of_crossing.end(), std::pair(n, 0))->second; };
  const auto corner_of = [&](int v) {
    for (int i = 0; i < 3; ++i)
      if (mesh_.from(3 * f + i) == v) return corner_station[i];
    throw Error(ErrorCode::Internal, "a curve ends outside the face that it runs through");
  };
  for (const auto& [n, at] : of_crossing) {
    const Crossing& x = crossings_[n];
    int side = 3 * f;
    while (mesh_.edge[side] != x.edge) ++side;
    const bool up = mesh_.from(side) < mesh_.to(side);
    if (x.next_left == up)
      out.chords.push_back({x.curve, at, x.next >= 0 ? station(x.next) : corner_of(curves_[x.curve].end), n, x.next});
    else if (x.previous < 0)
      out.chords.push_back({x.curve, corner_of(curves_[x.curve].start), at, -1, n});
  }
  return out;
}

void SurfaceCurves::find_cells(int f, FaceCells& out) const {
  out.gaps.clear(), out.corners.clear();
  bool empty = true;
  for (int h = 3 * f; h < 3 * f + 3; ++h) empty = empty && on_edge_[mesh_.edge[h]].empty();
  if (empty) {
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      if (mesh_.opposite[h] >= 0 && along_[mesh_.edge[h]] < 0) out.gaps.push_back({h, 0, -1, 0, 1, 0});
      out.corners.push_back({h, 0, 0});
    }
    return;
  }
  const FacePolygon poly = polygon(f);
  // A cell is told by the sides of the chords on which it lies.
  std::vector<std::vector<char>> sides;
  const auto cell = [&](std::vector<char> of) {
    const auto at = std::find(sides.begin(), sides.end(), of);
    if (at != sides.end()) return static_cast<int>(at - sides.begin());
    sides.push_back(std::move(of));
    return static_cast<int>(sides.size()) - 1;
  };
  const int count = static_cast<int>(poly.stations.size());
  std::vector<char> of(poly.chords.size());
  int side = 0;
  for (int s = 0; s < count; ++s) {
    const Station &here = poly.stations[s], &next = poly.stations[(s + 1) % count];
    if (here.corner >= 0) {
      side = here.corner;
      // The chords that end here, counter-clockwise: by how far on their other ends are.
      std::vector<std::pair<int, int>> ends;
      for (std::size_t k = 0; k < poly.chords.size(); ++k) {
        const Chord& c = poly.chords[k];
        if (c.from == s || c.to == s) ends.push_back({((c.from == s ? c.to : c.from) - s + count) % count, static_cast<int>(k)});
      }
      std::sort(ends.begin(), ends.end());
      for (std::size_t k = 0; k < of.size(); ++k) {
        const auto [low, high] = std::minmax(poly.chords[k].from, poly.chords[k].to);
        of[k] = s > low && s < high;
      }
      for (int rank = 0; rank <= static_cast<int>(ends.size()); ++rank) {
        for (int k = 0; k < static_cast<int>(ends.size()); ++k) {
          const Chord& c = poly.chords[ends[k].second];
          of[ends[k].second] = (k >= rank) == (std::min(c.from, c.to) == s);
        }
        out.corners.push_back({3 * f + side, rank, cell(of)});
      }
    }
    const int h = 3 * f + side, e = mesh_.edge[h];
    if (mesh_.opposite[h] < 0 || along_[e] >= 0) continue;
    for (std::size_t k = 0; k < of.size(); ++k) {
      const auto [low, high] = std::minmax(poly.chords[k].from, poly.chords[k].to);
      of[k] = s >= low && s < high;
    }
    const bool up = mesh_.from(h) < mesh_.to(h);
    const int crossing = up ? here.crossing : next.crossing;
    int rank = 0;
    if (crossing >= 0) rank = static_cast<int>(std::find(on_edge_[e].begin(), on_edge_[e].end(), crossing) - on_edge_[e].begin()) + 1;
    out.gaps.push_back({h, rank, crossing, here.corner >= 0 ? 0 : here.weights[(side + 1) % 3], next.corner >= 0 ? 1 : next.weights[(side + 1) % 3], cell(of)});
  }
}

bool SurfaceCurves::alternate(const Chord& a, const Chord& b) {
  const int low = std::min(a.from, a.to), high = std::max(a.from, a.to);
  if (b.from == low || b.from == high || b.to == low || b.to == high) return false;
  return (b.from > low && b.from < high) != (b.to > low && b.to < high);
}

// --- growth --------------------------------------------------------------------------------------------------------------------

int SurfaceCurves::add_vertex(const std::array<int, 3>& of, const std::array<double, 3>& weights) {
  std::array<const PointSource*, 3> sources{nullptr, nullptr, nullptr};
  Vec3 at = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 0) continue;
    sources[i] = &source_[of[i]];
    at += weights[i] * points_[of[i]];
  }
  const PointSource source = combine(sources, weights);
  source_.push_back(source);
  points_.push_back(at);
  mesh_.out.push_back(-1);
  mesh_.vertex_live.push_back(1);
  ++mesh_.vertex_count;
  degree_.push_back(0);
  return static_cast<int>(points_.size()) - 1;
}

int SurfaceCurves::add_face(int like) {
  mesh_.origin.insert(mesh_.origin.end(), 3, -1);
  mesh_.opposite.insert(mesh_.opposite.end(), 3, -1);
  mesh_.edge.insert(mesh_.edge.end(), 3, -1);
  mesh_.alive.push_back(1);
  ++mesh_.face_count;
  source_face_.push_back(source_face_[like]);
  return static_cast<int>(mesh_.alive.size()) - 1;
}

int SurfaceCurves::add_edge(int h) {
  half_edge_.push_back(h);
  on_edge_.emplace_back();
  along_.push_back(-1);
  return mesh_.edge_count++;
}

void SurfaceCurves::put(int h, int origin, int edge, int opposite) {
  mesh_.origin[h] = origin;
  mesh_.edge[h] = edge;
  mesh_.opposite[h] = opposite;
  if (opposite >= 0) mesh_.opposite[opposite] = h;
  half_edge_[edge] = h;
}

int SurfaceCurves::split_face(int f, const std::array<double, 3>& weights, const std::vector<int>& through) {
  const FacePolygon poly = polygon(f);
  const std::vector<Station>& stations = poly.stations;
  const int count = static_cast<int>(stations.size());
  const std::array<int, 3> corners{mesh_.from(3 * f), mesh_.from(3 * f + 1), mesh_.from(3 * f + 2)};

  // The arc of the face's rim that a chord takes from the new vertex's sight: with as few as possible of the ends of the curves that are to end there.
  struct Arc {
    int chord, low, span;
    bool forward;
  };
  std::vector<Arc> arcs;
  for (int i = 0; i < static_cast<int>(poly.chords.size()); ++i) {
    if (std::find(through.begin(), through.end(), i) != through.end()) continue;
    const Chord& c = poly.chords[i];
    const int low = std::min(c.from, c.to), high = std::max(c.from, c.to);
    int within = 0, without = 0;
    for (const int k : through)
      for (const int s : {poly.chords[k].from, poly.chords[k].to})
        if (s != low && s != high) ++(s > low && s < high ? within : without);
    const bool seen_left = turn(stations[low].weights, stations[high].weights, weights) > 0;
    if (within != without ? within < without : seen_left)
      arcs.push_back({i, low, high - low, c.from == low});
    else
      arcs.push_back({i, high, count - (high - low), c.from == high});
  }

  // f keeps its first side; the faces at the other two are new.
  const int x = add_vertex(corners, weights);
  const int g = add_face(f), k = add_face(f);
  const std::array<int, 3> spoke{add_edge(3 * f + 2), add_edge(3 * f + 1), add_edge(3 * g + 1)};  // per corner
  const int side1 = mesh_.edge[3 * f + 1], side2 = mesh_.edge[3 * f + 2], across1 = mesh_.opposite[3 * f + 1], across2 = mesh_.opposite[3 * f + 2];
  put(3 * g, corners[1], side1, across1);
  put(3 * k, corners[2], side2, across2);
  put(3 * g + 1, corners[2], spoke[2], -1);
  put(3 * k + 2, x, spoke[2], 3 * g + 1);
  put(3 * f + 1, corners[1], spoke[1], -1);
  put(3 * g + 2, x, spoke[1], 3 * f + 1);
  put(3 * k + 1, corners[0], spoke[0], -1);
  put(3 * f + 2, x, spoke[0], 3 * k + 1);
  if (mesh_.out[corners[1]] == 3 * f + 1) mesh_.out[corners[1]] = 3 * g;
  if (mesh_.out[corners[2]] == 3 * f + 2) mesh_.out[corners[2]] = 3 * k;
  mesh_.out[x] = 3 * f + 2;

  // Lead the chords across the spokes inside their arcs, those with the larger arcs nearer to x.
  struct Hit {
    int span, crossing;
  };
  std::array<std::vector<Hit>, 3> hits;
  for (const Arc& arc : arcs) {
    const Chord& c = poly.chords[arc.chord];
    int previous = c.from_crossing;
    for (int s = 1; s < arc.span; ++s) {
      const Station& at = stations[(arc.low + (arc.forward ? s : arc.span - s)) % count];
      if (at.corner < 0) continue;
      const int n = new_crossing();
      crossings_[n].edge = spoke[at.corner];
      crossings_[n].t = meeting(stations[c.from].weights, stations[c.to].weights, at.weights, weights);
      crossings_[n].next_left = !arc.forward;
      link_after(c.curve, previous, n);
      previous = n;
      hits[at.corner].push_back({arc.span, n});
    }
  }
  for (int i = 0; i < 3; ++i) {
    std::stable_sort(hits[i].begin(), hits[i].end(), [](const Hit& a, const Hit& b) { return a.span < b.span; });
    for (const Hit& hit : hits[i]) on_edge_[spoke[i]].push_back(hit.crossing);
    spread(spoke[i]);
  }
  for (const int i : through) {
    const int p = poly.chords[i].from_crossing, q = poly.chords[i].to_crossing;
    split_between(crossings_[p >= 0 ? p : q].curve, p, q, x);
  }
  return x;
}

int SurfaceCurves::split_edge(int h, double t, int through) {
  const int o = mesh_.opposite[h];
  const int a = mesh_.from(h), b = mesh_.to(h), e = mesh_.edge[h];
  const bool up = a < b;
  t = inside(t);
  // The crossings before and after the new vertex, from a to b.
  std::vector<int> before = on_edge_[e];
  if (!up) std::reverse(before.begin(), before.end());
  const auto from_a = [&](int n) { return up ? crossings_[n].t : 1 - crossings_[n].t; };
  auto middle = std::find(before.begin(), before.end(), through);
  std::vector<int> after;
  if (through >= 0) {
    t = inside(from_a(through));
    after.assign(middle + 1, before.end());
  } else {
    middle = std::find_if(before.begin(), before.end(), [&](int n) { return from_a(n) > t; });
    after.assign(middle, before.end());
  }
  before.erase(middle, before.end());

  // What crosses the new edges from the apexes to the vertex: chords from one part of the rim to the other, those that cut off the shorter arc at the apex first.
  struct Hit {
    int key;
    Chord chord;
    bool to_second;  // goes on into the part that holds the end of the side
    double t;
  };
  const auto hits_of = [&](int side, double at) {
    std::vector<Hit> hits;
    const FacePolygon poly = polygon(side / 3);
    const int count = static_cast<int>(poly.stations.size()), i = side % 3, apex = (i + 2) % 3;
    int first = 0;
    while (poly.stations[first].corner != apex) ++first;
    std::array<double, 3> x{0, 0, 0}, top{0, 0, 0};
    x[i] = 1 - at, x[(i + 1) % 3] = at, top[apex] = 1;
    // Counted from the apex: 0, then the part of the side's start up to `limit`, then that of its end. The chord's ends at the vertex itself and at the apex cross nothing.
    const std::vector<int>& near = side == h ? before : after;
    int limit = 0;
    while (poly.stations[(first + limit) % count].corner != i) ++limit;
    limit += static_cast<int>(near.size());
    for (const Chord& c : poly.chords) {
      if (through >= 0 && (c.from_crossing == through || c.to_crossing == through)) continue;
      const int p = (c.from - first + count) % count, q = (c.to - first + count) % count;
      if (p == 0 || q == 0 || (p <= limit) == (q <= limit)) continue;
      hits.push_back({std::min(p, q) + count - std::max(p, q), c, p < q, meeting(poly.stations[c.from].weights, poly.stations[c.to].weights, top, x)});
    }
    std::stable_sort(hits.begin(), hits.end(), [](const Hit& l, const Hit& r) { return l.key < r.key; });
    return hits;
  };
  const std::vector<Hit> left = hits_of(h, t), right = o >= 0 ? hits_of(o, 1 - t) : std::vector<Hit>();

  const int f = h / 3, n = EditMesh::next(h), p = EditMesh::prev(h), c = mesh_.from(p);
  const int x = add_vertex({a, b, -1}, {1 - t, t, 0});
  const int nf = add_face(f), e2 = add_edge(3 * nf), ec = add_edge(n);
  put(3 * nf + 1, b, mesh_.edge[n], mesh_.opposite[n]);
  put(n, x, ec, -1);
  put(3 * nf + 2, c, ec, n);
  put(3 * nf, x, e2, -1);
  if (mesh_.out[b] == n || mesh_.out[b] == o) mesh_.out[b] = 3 * nf + 1;
  mesh_.out[x] = 3 * nf;
  int ed = -1;
  if (o >= 0) {
    const int g = o / 3, op = EditMesh::prev(o), d = mesh_.from(op);
    const int ng = add_face(g);
    ed = add_edge(op);
    put(3 * ng + 2, d, mesh_.edge[op], mesh_.opposite[op]);
    put(3 * ng, b, e2, 3 * nf);
    put(3 * ng + 1, x, ed, -1);
    put(op, d, ed, 3 * ng + 1);
    put(o, x, e, h);
    if (mesh_.out[d] == op) mesh_.out[d] = 3 * ng + 2;
  }
  half_edge_[e] = h;

  // Crossings of the two halves: the new vertex is the larger end of both.
  on_edge_[e] = before;
  on_edge_[e2].assign(after.rbegin(), after.rend());
  for (const int m : before) {
    crossings_[m].t = inside((up ? crossings_[m].t : 1 - crossings_[m].t) / t);
    if (!up) crossings_[m].next_left = !crossings_[m].next_left;
  }
  for (const int m : after) {
    crossings_[m].t = inside((up ? 1 - crossings_[m].t : crossings_[m].t) / (1 - t));
    if (up) crossings_[m].next_left = !crossings_[m].next_left;
    crossings_[m].edge = e2;
  }
  spread(e), spread(e2);
  for (const auto& [hits, edge] : {std::pair(&left, ec), std::pair(&right, ed)}) {
    for (const Hit& hit : *hits) {
      const int m = new_crossing();
      crossings_[m].edge = edge;
      crossings_[m].t = hit.t;
      crossings_[m].next_left = hit.to_second;
      link_after(hit.chord.curve, hit.chord.from_crossing, m);
      on_edge_[edge].push_back(m);
    }
    if (edge >= 0) spread(edge);
  }
  if (const int curve = along_[e]; curve >= 0) {
    // The part that reaches to b is the edge e2.
    along_[e] = -1;
    curves_[curve].along = -1;
    split_between(curve, -1, -1, x);
  }
  if (through >= 0) {
    const int previous = crossings_[through].previous, next = crossings_[through].next;
    split_between(crossings_[through].curve, previous, next, x);
    crossings_[through] = Crossing();
    free_.push_back(through);
  }
  return x;
}

int SurfaceCurves::split_curve(int n) {
  const int h = half_edge_[crossings_[n].edge];
  return split_edge(h, 0.5, n);
}

// --- links -----------------------------------------------------------------------------------------------------------------------

int SurfaceCurves::new_crossing() {
  if (free_.empty()) {
    crossings_.emplace_back();
    return static_cast<int>(crossings_.size()) - 1;
  }
  const int n = free_.back();
  free_.pop_back();
  crossings_[n] = Crossing();
  return n;
}

// Puts crossing n into the curve after `previous` (-1: at its start).
void SurfaceCurves::link_after(int c, int previous, int n) {
  const int next = previous >= 0 ? crossings_[previous].next : curves_[c].first;
  crossings_[n].curve = c;
  crossings_[n].previous = previous;
  crossings_[n].next = next;
  (previous >= 0 ? crossings_[previous].next : curves_[c].first) = n;
  (next >= 0 ? crossings_[next].previous : curves_[c].last) = n;
}

void SurfaceCurves::unlink(int n) {
  const Crossing& x = crossings_[n];
  (x.previous >= 0 ? crossings_[x.previous].next : curves_[x.curve].first) = x.next;
  (x.next >= 0 ? crossings_[x.next].previous : curves_[x.curve].last) = x.previous;
  crossings_[n] = Crossing();
  free_.push_back(n);
}

void SurfaceCurves::erase(int n) {
  std::vector<int>& list = on_edge_[crossings_[n].edge];
  list.erase(std::find(list.begin(), list.end(), n));
  unlink(n);
}

int SurfaceCurves::insert(int c, int previous, int h, int below, double t) {
  const int n = new_crossing(), e = mesh_.edge[h];
  const bool up = mesh_.from(h) < mesh_.to(h);
  crossings_[n].edge = e;
  crossings_[n].t = inside(up ? t : 1 - t);
  crossings_[n].next_left = !up;  // on to the right of h
  link_after(c, previous, n);
  std::vector<int>& list = on_edge_[e];
  list.insert(below < 0 ? list.begin() : std::find(list.begin(), list.end(), below) + 1, n);
  return n;
}

int SurfaceCurves::insert_nearest(int c, int previous, int h, int v) {
  const std::vector<int>& list = on_edge_[mesh_.edge[h]];
  const bool at_low = v == low(mesh_.edge[h]);
  double near = 0.5;  // from v
  if (!list.empty()) near = 0.5 * (at_low ? crossings_[list.front()].t : 1 - crossings_[list.back()].t);
  return insert(c, previous, h, at_low || list.empty() ? -1 : list.back(), v == mesh_.from(h) ? near : 1 - near);
}

// Ends curve c at x between its crossings p and q (-1: its start or end) and begins a new one there.
int SurfaceCurves::split_between(int c, int p, int q, int x) {
  const int d = static_cast<int>(curves_.size());
  Curve rest = curves_[c];
  rest.start = x;
  rest.first = q;
  rest.along = -1;
  if (q < 0) rest.last = -1;
  curves_.push_back(rest);
  curves_[c].end = x;
  curves_[c].last = p;
  if (p < 0) curves_[c].first = -1;
  if (p >= 0) crossings_[p].next = -1;
  if (q >= 0) crossings_[q].previous = -1;
  for (int n = q; n >= 0; n = crossings_[n].next) crossings_[n].curve = d;
  degree_[x] += 2;
  if (p < 0 && !set_along(c)) throw Error(ErrorCode::Internal, "two curves along one edge");
  if (q < 0 && !set_along(d)) throw Error(ErrorCode::Internal, "two curves along one edge");
  return d;
}

// Makes a curve without crossings an edge, if there is one that is free.
bool SurfaceCurves::set_along(int c) {
  const Curve& curve = curves_[c];
  if (curve.start == curve.end) return false;
  int h = mesh_.find(curve.start, curve.end);
  if (h < 0) h = mesh_.find(curve.end, curve.start);
  if (h < 0 || mesh_.opposite[h] < 0 || along_[mesh_.edge[h]] >= 0) return false;
  along_[mesh_.edge[h]] = c;
  curves_[c].along = mesh_.edge[h];
  return true;
}

void SurfaceCurves::clear_along(int c) {
  if (curves_[c].along >= 0) along_[curves_[c].along] = -1;
  curves_[c].along = -1;
}

void SurfaceCurves::reverse(int c) {
  Curve& curve = curves_[c];
  std::swap(curve.start, curve.end);
  for (int n = curve.first; n >= 0;) {
    Crossing& x = crossings_[n];
    n = x.next;
    std::swap(x.previous, x.next);
    x.next_left = !x.next_left;
  }
  std::swap(curve.first, curve.last);
}

void SurfaceCurves::remove(int c) {
  while (curves_[c].first >= 0) erase(curves_[c].first);
  clear_along(c);
  --degree_[curves_[c].start];
  --degree_[curves_[c].end];
  curves_[c].alive = false;
}

// --- curves ----------------------------------------------------------------------------------------------------------------------

int SurfaceCurves::add(int start, int end, const std::vector<Step>& steps, int stroke) {
  std::vector<Step> path;
  for (const Step& s : steps) {
    if (!path.empty() && mesh_.edge[path.back().half_edge] == mesh_.edge[s.half_edge])
      path.pop_back();
    else
      path.push_back(s);
  }
  const auto touches = [&](const Step& s, int v) { return mesh_.from(s.half_edge) == v || mesh_.to(s.half_edge) == v; };
  while (!path.empty() && touches(path.back(), end)) path.pop_back();
  std::size_t begin = 0;
  while (begin < path.size() && touches(path[begin], start)) ++begin;
  const int c = static_cast<int>(curves_.size());
  curves_.push_back({start, end, -1, -1, -1, stroke, true});
  ++degree_[start], ++degree_[end];
  int previous = -1;
  for (std::size_t i = begin; i < path.size(); ++i) {
    const int h = path[i].half_edge, e = mesh_.edge[h];
    const double t = mesh_.from(h) < mesh_.to(h) ? path[i].t : 1 - path[i].t;
    const std::vector<int>& list = on_edge_[e];
    const auto above = std::upper_bound(list.begin(), list.end(), inside(t), [&](double value, int n) { return value < crossings_[n].t; });
    previous = insert(c, previous, h, above == list.begin() ? -1 : *(above - 1), path[i].t);
  }
  if (previous >= 0 || set_along(c)) return c;
  remove(c);
  return -1;
}

int SurfaceCurves::add(int start, int end, const std::vector<Gap>& gaps, int stroke) {
  const int c = static_cast<int>(curves_.size());
  curves_.push_back({start, end, -1, -1, -1, stroke, true});
  ++degree_[start], ++degree_[end];
  int previous = -1;
  for (const Gap& g : gaps) previous = insert(c, previous, g.half_edge, g.below, 0.5 * (g.from + g.to));
  for (const Gap& g : gaps) spread(mesh_.edge[g.half_edge]);
  return simplify(c) ? c : -1;
}

void SurfaceCurves::resolve_crossings(const Progress& progress) {
  std::vector<int> faces, edges;
  for (int e = 0; e < mesh_.edge_count; ++e) {
    spread(e);
    if (on_edge_[e].empty()) continue;
    edges.push_back(e);
    for (const int h : {half_edge_[e], mesh_.opposite[half_edge_[e]]})
      if (h >= 0) faces.push_back(h / 3);
  }
  const auto look_around = [&](int x) {
    int g = mesh_.out[x];
    do {
      edges.push_back(mesh_.edge[g]);
      edges.push_back(mesh_.edge[EditMesh::next(g)]);
      faces.push_back(g / 3);
      g = mesh_.ccw(g);
    } while (g >= 0 && g != mesh_.out[x]);
  };
  for (int steps = 0; !faces.empty() || !edges.empty(); ++steps) {
    if (steps % 256 == 0) progress.check();
    if (!edges.empty()) {
      const int e = edges.back();
      edges.pop_back();
      if (along_[e] >= 0 && !on_edge_[e].empty()) look_around(split_curve(on_edge_[e][0]));
      continue;
    }
    const int f = faces.back();
    faces.pop_back();
    const FacePolygon poly = polygon(f);
    const int count = static_cast<int>(poly.chords.size());
    int i = -1, j = -1;
    for (int k = 0; k < count && i < 0; ++k)
      for (int l = k + 1; l < count && i < 0; ++l)
        if (alternate(poly.chords[k], poly.chords[l])) i = k, j = l;
    if (i < 0) continue;
    const Chord &a = poly.chords[i], &b = poly.chords[j];
    const auto &p = poly.stations[a.from].weights, &q = poly.stations[a.to].weights;
    const double t = meeting(poly.stations[b.from].weights, poly.stations[b.to].weights, p, q);
    std::array<double, 3> at{};
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += at[k] = std::max((1 - t) * p[k] + t * q[k], kLeastGap);
    for (double& w : at) w /= sum;
    look_around(split_face(f, at, {i, j}));
  }
}

bool SurfaceCurves::simplify(int c) {
  if (curves_[c].along >= 0) return true;
  const auto beside = [&](int n, int v) { return (low(crossings_[n].edge) == v || high(crossings_[n].edge) == v) && is_nearest(n, v); };
  for (bool changed = true; changed;) {
    changed = false;
    while (curves_[c].first >= 0 && beside(curves_[c].first, curves_[c].start)) erase(curves_[c].first), changed = true;
    while (curves_[c].last >= 0 && beside(curves_[c].last, curves_[c].end)) erase(curves_[c].last), changed = true;
    for (int n = curves_[c].first; n >= 0;) {
      const int m = crossings_[n].next;
      if (m < 0 || crossings_[m].edge != crossings_[n].edge) {
        n = m;
        continue;
      }
      // Out and in again: what runs in between, if anything, has to go first.
      const std::vector<int>& list = on_edge_[crossings_[n].edge];
      const auto i = std::find(list.begin(), list.end(), n) - list.begin(), j = std::find(list.begin(), list.end(), m) - list.begin();
      if (std::abs(i - j) != 1) {
        n = m;
        continue;
      }
      const int previous = crossings_[n].previous;
      erase(m), erase(n);
      changed = true;
      n = previous >= 0 ? previous : curves_[c].first;
    }
  }
  if (curves_[c].first >= 0 || set_along(c)) return true;
  remove(c);
  return false;
}

void SurfaceCurves::simplify_all(std::vector<int> curves) {
  std::sort(curves.begin(), curves.end());
  curves.erase(std::unique(curves.begin(), curves.end()), curves.end());
  // What lies inside goes first: again until nothing is left to do.
  const auto size = [&] {
    int sum = 0;
    for (const int c : curves)
      for (int n = curves_[c].first; n >= 0; n = crossings_[n].next) ++sum;
    return sum;
  };
  for (int before = -1; before != size();) {
    before = size();
    for (const int c : curves)
      if (curves_[c].alive) simplify(c);
  }
}

// --- geometry --------------------------------------------------------------------------------------------------------------------

void SurfaceCurves::spread(int edge) {
  const std::vector<int>& list = on_edge_[edge];
  if (list.empty()) return;
  const double gap = std::min(kLeastGap, 0.5 / (list.size() + 1.0));
  double least = gap;
  for (const int n : list) {
    Crossing& x = crossings_[n];
    x.t = std::isfinite(x.t) ? std::max(x.t, least) : least;
    least = x.t + gap;
  }
  double most = 1 - gap;
  for (std::size_t k = list.size(); k-- > 0;) {
    Crossing& x = crossings_[list[k]];
    if (x.t > most) x.t = most;
    most = x.t - gap;
  }
}

void SurfaceCurves::spread() {
  for (int e = 0; e < mesh_.edge_count; ++e) spread(e);
}

// --- results ---------------------------------------------------------------------------------------------------------------------

CutMesh SurfaceCurves::cut() const {
  CutMesh out;
  out.mesh.points = points_;
  out.source = source_;
  out.chains.resize(curves_.size());
  std::vector<int> point_of(crossings_.size(), -1);
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    if (!curves_[c].alive) continue;
    out.chains[c].push_back(curves_[c].start);
    for (int n = curves_[c].first; n >= 0; n = crossings_[n].next) {
      const Crossing& x = crossings_[n];
      point_of[n] = static_cast<int>(out.mesh.points.size());
      out.chains[c].push_back(point_of[n]);
      out.mesh.points.push_back(position(n));
      out.source.push_back(combine({&source_[low(x.edge)], &source_[high(x.edge)], nullptr}, {1 - x.t, x.t, 0}));
    }
    out.chains[c].push_back(curves_[c].end);
  }
  const std::array<Vec2, 3> reference{Vec2(0, 0), Vec2(1, 0), Vec2(0.5, std::sqrt(0.75))};
  for (int f = 0; f < face_count(); ++f) {
    const FacePolygon poly = polygon(f);
    std::vector<PieceCorner> corners;
    int side = 0;
    for (const Station& s : poly.stations) {
      if (s.corner >= 0) side = s.corner;
      PieceCorner c{};
      c.point = s.corner >= 0 ? mesh_.from(3 * f + s.corner) : point_of[s.crossing];
      // A side with crossings is not a curve itself.
      c.mark = s.corner >= 0 ? along_[mesh_.edge[3 * f + side]] : -1;
      c.sides = s.corner >= 0 ? (1 << side) | (1 << ((side + 2) % 3)) : 1 << side;
      c.at = s.weights[0] * reference[0] + s.weights[1] * reference[1] + s.weights[2] * reference[2];
      corners.push_back(c);
    }
    const auto emit = [&](const PieceCorner& a, const PieceCorner& b, const PieceCorner& c, int ab, int bc, int ca) {
      out.mesh.faces.push_back({a.point, b.point, c.point});
      out.mesh.source_face.push_back(source_face_[f]);
      out.curve.insert(out.curve.end(), {ab, bc, ca});
    };
    std::vector<FaceChord> chords;
    for (const Chord& c : poly.chords) chords.push_back({std::min(c.from, c.to), std::max(c.from, c.to), c.curve});
    split_along_chords(corners, chords, emit);
  }
  connect_half_edges(out.mesh);
  return out;
}

const char* SurfaceCurves::find_defect() const {
  std::vector<char> listed(crossings_.size(), 0);
  for (int e = 0; e < mesh_.edge_count; ++e) {
    if (mesh_.edge[half_edge_[e]] != e) return "an edge without a half-edge";
    if (!on_edge_[e].empty() && mesh_.opposite[half_edge_[e]] < 0) return "a curve crosses the boundary";
    if (!on_edge_[e].empty() && along_[e] >= 0) return "a curve crosses another that is an edge";
    double last = 0;
    for (const int n : on_edge_[e]) {
      if (crossings_[n].edge != e || crossings_[n].curve < 0 || listed[n]) return "a crossing is listed on another edge than its own, or twice";
      if (!(crossings_[n].t > last && crossings_[n].t < 1)) return "the crossings of an edge are out of order";
      last = crossings_[n].t;
      listed[n] = 1;
    }
  }
  std::vector<int> degree(points_.size(), 0);
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    const Curve& curve = curves_[c];
    if (!curve.alive) continue;
    ++degree[curve.start], ++degree[curve.end];
    if ((curve.first < 0) != (curve.along >= 0)) return "a curve without crossings is no edge";
    if (curve.along >= 0) {
      if (along_[curve.along] != static_cast<int>(c)) return "a curve's edge does not know it";
      if (std::minmax(curve.start, curve.end) != std::minmax(low(curve.along), high(curve.along))) return "a curve is an edge between other vertices";
      continue;
    }
    int previous = -1;
    for (int n = curve.first; n >= 0; n = crossings_[n].next) {
      const Crossing& x = crossings_[n];
      if (x.curve != static_cast<int>(c) || x.previous != previous || !listed[n]) return "a curve's crossings are not linked";
      const int face = leaving(n) / 3;
      if (previous < 0 ? mesh_.apex(leaving(n)) != curve.start : mesh_.opposite[leaving(previous)] / 3 != face) return "a curve goes from one face to another without crossing";
      if (previous >= 0 && crossings_[previous].edge == x.edge) return "a curve leaves a face where it came in";
      previous = n;
    }
    if (previous != curve.last || mesh_.apex(mesh_.opposite[leaving(previous)]) != curve.end) return "a curve does not reach its end";
  }
  if (degree != degree_) return "a vertex with another number of curve ends than it says";
  for (int f = 0; f < face_count(); ++f) {
    const FacePolygon poly = polygon(f);
    for (std::size_t i = 0; i < poly.chords.size(); ++i)
      for (std::size_t j = i + 1; j < poly.chords.size(); ++j)
        if (alternate(poly.chords[i], poly.chords[j])) return "two curves cross";
  }
  return "";
}

}  // namespace hybrid_mesh
