// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/curves/surface_curves.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace hybrid_mesh {

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

double SurfaceCurves::inside(double t) { return std::isfinite(t) ? std::clamp(t, kLeastGap, 1 - kLeastGap) : 0.5; }

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
      if ((at_start ? x.previous : x.next) < 0 && (at_start ? curves_[x.curve].start : curves_[x.curve].end) == v)
        ends.push_back({x.curve, at_start, g, false});
    }
    g = mesh_.ccw(g);
  } while (g >= 0 && g != mesh_.out[v]);
  return ends;
}

// --- links ----------------------------------------------------------------------------------------------------

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

// --- curves ----------------------------------------------------------------------------------------------------

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
  std::vector<int> edges;
  for (const int c : curves)
    for (int n = curves_[c].first; n >= 0; n = crossings_[n].next) edges.push_back(crossings_[n].edge);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const int e : edges) spread(e);
}

// --- geometry ----------------------------------------------------------------------------------------------------

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

}  // namespace hybrid_mesh
