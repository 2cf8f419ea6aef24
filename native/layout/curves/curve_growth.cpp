// SPDX-License-Identifier: GPL-3.0-or-later
// Vertices put into a surface with curves on it: where it is split, and where curves cross.
#include <algorithm>
#include <cmath>

#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {
namespace {

// On which side of the line through p and q is x? All in barycentric coordinates.
double turn(const std::array<double, 3>& p, const std::array<double, 3>& q, const std::array<double, 3>& x) {
  return p[0] * (q[1] * x[2] - q[2] * x[1]) - p[1] * (q[0] * x[2] - q[2] * x[0]) + p[2] * (q[0] * x[1] - q[1] * x[0]);
}

// Where the line through p and q meets the segment from a to b, as a fraction of that.
double meeting(const std::array<double, 3>& p, const std::array<double, 3>& q, const std::array<double, 3>& a, const std::array<double, 3>& b) {
  const double at_a = turn(p, q, a), at_b = turn(p, q, b), t = at_a / (at_a - at_b);
  return t > 0 && t < 1 ? t : 0.5;
}

}  // namespace

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

  // The arc of the face's rim that a chord takes from the new vertex's sight: with as few as possible of the ends of the curves that are to end
  // there.
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

  // What crosses the new edges from the apexes to the vertex: chords from one part of the rim to the other, those that cut off the shorter arc at the
  // apex first.
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
    // Counted from the apex: 0, then the part of the side's start up to `limit`, then that of its end. The chord's ends at the vertex itself and at
    // the apex cross nothing.
    const std::vector<int>& near = side == h ? before : after;
    int limit = 0;
    while (poly.stations[(first + limit) % count].corner != i) ++limit;
    limit += static_cast<int>(near.size());
    for (const Chord& c : poly.chords) {
      if (through >= 0 && (c.from_crossing == through || c.to_crossing == through)) continue;
      const int p = (c.from - first + count) % count, q = (c.to - first + count) % count;
      if (p == 0 || q == 0 || (p <= limit) == (q <= limit)) continue;
      hits.push_back(
          {std::min(p, q) + count - std::max(p, q), c, p < q, meeting(poly.stations[c.from].weights, poly.stations[c.to].weights, top, x)});
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

}  // namespace hybrid_mesh
