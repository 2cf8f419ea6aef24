// SPDX-License-Identifier: GPL-3.0-or-later
// Moves the ends of curves from one vertex to another, along a curve or along the boundary.
#include <algorithm>

#include "base/error.h"
#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {

// Turns the curve so that it ends with `end`, open to be led on.
void SurfaceCurves::open_end(const End& end) {
  if (end.at_start) reverse(end.curve);
  clear_along(end.curve);
}

// Leads the curve that ends with `end` at a vertex on to the other end of the curve that leaves the vertex with `guide`: around the vertex clockwise
// up to the guide, then along it on its left. `before`: both leave through one face, `end` clockwise of the guide, so that the way is a full turn.
void SurfaceCurves::extend(const End& end, const End& guide, bool before) {
  const int c = end.curve, v = mesh_.from(end.spoke);
  // The spokes counter-clockwise from the guide to the curve.
  std::vector<int> spokes;
  const bool neighbours = guide.spoke == end.spoke && !end.along && !before;
  for (int g = guide.spoke; !neighbours;) {
    g = mesh_.ccw(g);
    if (g < 0) throw Error(ErrorCode::Internal, "a curve is led around a vertex of the boundary");
    if (end.along && g == end.spoke) break;
    spokes.push_back(g);
    if (g == end.spoke) break;
  }
  open_end(end);
  int previous = curves_[c].last;
  for (std::size_t k = spokes.size(); k-- > 0;) previous = insert_nearest(c, previous, spokes[k], v);
  const Curve& along = curves_[guide.curve];
  for (int m = guide.at_start ? along.first : along.last; m >= 0; m = guide.at_start ? crossings_[m].next : crossings_[m].previous) {
    const int h = guide.at_start ? leaving(m) : mesh_.opposite[leaving(m)];
    // Left of the guide is towards to(h).
    const std::vector<int>& list = on_edge_[crossings_[m].edge];
    const auto at = std::find(list.begin(), list.end(), m);
    const bool up = mesh_.from(h) < mesh_.to(h);
    const double t = up ? crossings_[m].t : 1 - crossings_[m].t;
    previous = insert(c, previous, h, up ? m : at == list.begin() ? -1 : *(at - 1), t);
  }
  --degree_[curves_[c].end];
  curves_[c].end = guide.at_start ? along.end : along.start;
  ++degree_[curves_[c].end];
}

void SurfaceCurves::contract(int c, int v) {
  std::vector<int> moved;
  for (;;) {
    const std::vector<End> ends = ends_at(v);
    const auto guide = std::find_if(ends.begin(), ends.end(), [&](const End& e) { return e.curve == c; });
    if (guide == ends.end()) throw Error(ErrorCode::Internal, "a curve does not end where it is contracted");
    if (ends.size() == 1) break;
    // The next one counter-clockwise goes first: those that follow come between it and the guide.
    const auto end = guide + 1 == ends.end() ? ends.begin() : guide + 1;
    if (end->curve == c) throw Error(ErrorCode::Internal, "a closed curve cannot be contracted");
    moved.push_back(end->curve);
    extend(*end, *guide, end < guide && end->spoke == guide->spoke);
  }
  remove(c);
  simplify_all(std::move(moved));
}

void SurfaceCurves::slide(int v, int to, bool forward) {
  // The spokes to be crossed once past v, with the boundary vertex that each leaves.
  std::vector<std::pair<int, int>> spokes;
  const auto before = [&](int w) {
    int g = mesh_.out[w];
    while (mesh_.ccw(g) >= 0) g = mesh_.ccw(g);
    return mesh_.apex(g);
  };
  for (int w = forward ? mesh_.to(mesh_.out[v]) : before(v); w != to; w = forward ? mesh_.to(mesh_.out[w]) : before(w)) {
    if (w == v) throw Error(ErrorCode::Internal, "two vertices are on different boundaries");
    std::vector<int> inner;  // counter-clockwise
    for (int g = mesh_.ccw(mesh_.out[w]); g >= 0; g = mesh_.ccw(g)) inner.push_back(g);
    if (forward) std::reverse(inner.begin(), inner.end());
    for (const int g : inner) spokes.push_back({g, w});
  }
  std::vector<int> moved;
  for (;;) {
    std::vector<End> ends = ends_at(v);
    if (ends.empty()) break;
    const End end = forward ? ends.front() : ends.back();
    const int c = end.curve;
    std::vector<std::pair<int, int>> way;
    if (forward) {
      for (int g = end.along ? mesh_.cw(end.spoke) : end.spoke; mesh_.opposite[g] >= 0; g = mesh_.cw(g)) way.push_back({g, v});
    } else {
      for (int g = mesh_.ccw(end.spoke); g >= 0; g = mesh_.ccw(g)) way.push_back({g, v});
    }
    way.insert(way.end(), spokes.begin(), spokes.end());
    open_end(end);
    int previous = curves_[c].last;
    // With the boundary on the right, spokes are left clockwise.
    for (const auto& [g, pivot] : way) previous = insert_nearest(c, previous, forward ? g : mesh_.opposite[g], pivot);
    --degree_[v];
    curves_[c].end = to;
    ++degree_[to];
    moved.push_back(c);
  }
  simplify_all(std::move(moved));
}

bool SurfaceCurves::dissolve(int v) {
  if (mesh_.is_boundary(v)) return false;
  const std::vector<End> ends = ends_at(v);
  if (ends.size() != 2 || ends[0].curve == ends[1].curve) return false;
  contract(ends[1].curve, v);
  return true;
}

}  // namespace hybrid_mesh
