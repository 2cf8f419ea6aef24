// SPDX-License-Identifier: GPL-3.0-or-later
// Point location is a visibility walk (Devillers, Pion, Teillaud, Walking in a triangulation, 2002) from a grid of buckets.
#include "parameterization/patch_map.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace hybrid_mesh {

namespace {

double orientation(const Vec2& a, const Vec2& b, double u, double v) { return (b.x() - a.x()) * (v - a.y()) - (b.y() - a.y()) * (u - a.x()); }

double surface_area(const PatchMap& map, const std::array<int, 3>& t) {
  return 0.5 * (map.positions[t[1]] - map.positions[t[0]]).cross(map.positions[t[2]] - map.positions[t[0]]).norm();
}

// Half-edges 3 t + i (corner i to corner i + 1) in buckets of the vertex they start from; shared by the sampler and the check.
class OutgoingHalfEdges {
 public:
  explicit OutgoingHalfEdges(const PatchMap& map) : map_(map), first_(map.uv.size() + 1, 0), half_(3 * map.triangles.size()) {
    for (const auto& t : map.triangles)
      for (int c : t) ++first_[c + 1];
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (std::size_t h = 0; h < half_.size(); ++h) half_[next[map.triangles[h / 3][h % 3]]++] = static_cast<int>(h);
  }
  // The first half-edge from a to b, -1 if there is none; `count` is how many there are.
  int find(int a, int b, int* count = nullptr) const {
    int found = -1, n = 0;
    for (int k = first_[a]; k < first_[a + 1]; ++k) {
      const int h = half_[k];
      if (map_.triangles[h / 3][h % 3 == 2 ? 0 : h % 3 + 1] != b) continue;
      if (n++ == 0) found = h;
    }
    if (count) *count = n;
    return found;
  }
  int valence(int v) const { return first_[v + 1] - first_[v]; }
  int outgoing(int v, int k) const { return half_[first_[v] + k]; }

 private:
  const PatchMap& map_;
  std::vector<int> first_, half_;
};

// A convex polygon with room for a triangle cut by the four lines of a cell.
struct ClippedPolygon {
  std::array<Vec2, 10> points;
  int size = 0;
};

// The part of a polygon on one side of a line along an axis: sign * (x[axis] - bound) >= 0.
void clip(const ClippedPolygon& in, int axis, double bound, double sign, ClippedPolygon& out) {
  out.size = 0;
  for (int i = 0; i < in.size; ++i) {
    const Vec2 &a = in.points[i], &b = in.points[i + 1 == in.size ? 0 : i + 1];
    const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da >= 0) out.points[out.size++] = a;
    if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
      Vec2 p = a + (b - a) * (da / (da - db));
      p[axis] = bound;
      out.points[out.size++] = p;
    }
  }
}

double area(const ClippedPolygon& p) {
  double twice = 0;
  for (int i = 2; i < p.size; ++i) twice += orientation(p.points[0], p.points[i - 1], p.points[i].x(), p.points[i].y());
  return 0.5 * twice;
}

int cell_of(double x, int n) { return std::clamp(static_cast<int>(std::floor(x * n)), 0, n - 1); }

}  // namespace

PatchSampler::PatchSampler(const PatchMap& map) : map_(&map) {
  const int n = static_cast<int>(map.triangles.size());
  neighbours_.assign(n, {-1, -1, -1});
  const OutgoingHalfEdges outgoing(map);
  for (int t = 0; t < n; ++t)
    for (int i = 0; i < 3; ++i) {
      const int across = outgoing.find(map.triangles[t][(i + 2) % 3], map.triangles[t][(i + 1) % 3]);
      neighbours_[t][i] = across < 0 ? -1 : across / 3;
    }
  buckets_ = std::clamp(static_cast<int>(std::sqrt(0.5 * n)), 1, 256);
  start_.assign(static_cast<std::size_t>(buckets_) * buckets_, -1);
  for (int t = 0; t < n; ++t) {
    const auto& tri = map.triangles[t];
    const Vec2 c = (map.uv[tri[0]] + map.uv[tri[1]] + map.uv[tri[2]]) / 3;
    int& start = start_[static_cast<std::size_t>(cell_of(c.y(), buckets_)) * buckets_ + cell_of(c.x(), buckets_)];
    if (start < 0) start = t;
  }
  // Empty buckets start where the one before them does.
  int last = 0;
  for (int& start : start_) last = start = start < 0 ? last : start;
}

int PatchSampler::search_all(double u, double v, std::array<double, 3>& weights) const {
  int best = -1;
  double best_least = -INFINITY;
  for (std::size_t t = 0; t < map_->triangles.size(); ++t) {
    const auto& c = map_->triangles[t];
    const double whole = orientation(map_->uv[c[0]], map_->uv[c[1]], map_->uv[c[2]].x(), map_->uv[c[2]].y());
    if (!(whole > 0)) continue;
    std::array<double, 3> w;
    for (int i = 0; i < 3; ++i) w[i] = orientation(map_->uv[c[(i + 1) % 3]], map_->uv[c[(i + 2) % 3]], u, v);
    const double least = std::min({w[0], w[1], w[2]}) / whole;
    if (least > best_least) {
      best_least = least;
      best = static_cast<int>(t);
      weights = w;
    }
  }
  if (best < 0) {  // nothing but degenerate triangles
    best = 0;
    weights = {1, 0, 0};
  }
  return best;
}

int PatchSampler::locate(double u, double v, std::array<double, 3>& weights) const {
  int t = start_[static_cast<std::size_t>(cell_of(v, buckets_)) * buckets_ + cell_of(u, buckets_)];
  // A walk in a triangulation that is not Delaunay may run in circles, but seldom does.
  int steps = 64 + 8 * static_cast<int>(std::sqrt(static_cast<double>(map_->triangles.size())));
  int previous = -1;
  while (steps-- > 0) {
    const auto& c = map_->triangles[t];
    int across = -1;
    double worst = 0;
    for (int i = 0; i < 3; ++i) {
      weights[i] = orientation(map_->uv[c[(i + 1) % 3]], map_->uv[c[(i + 2) % 3]], u, v);
      const int neighbour = neighbours_[t][i];
      if (weights[i] < worst && neighbour >= 0 && neighbour != previous) {
        worst = weights[i];
        across = neighbour;
      }
    }
    if (across < 0) {
      if (weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0) return t;
      break;
    }
    previous = t;
    t = across;
  }
  return search_all(u, v, weights);
}

PatchSample PatchSampler::operator()(double u, double v) const {
  PatchSample sample;
  sample.position = Vec3::Zero();
  if (map_->triangles.empty()) return sample;
  std::array<double, 3> w;
  const int t = locate(u, v, w);
  double sum = 0;
  for (double& x : w) sum += x = std::max(x, 0.0);
  if (sum > 0) {
    for (double& x : w) x /= sum;
  } else {
    w = {1, 0, 0};
  }
  sample.triangle = t;
  const auto& c = map_->triangles[t];
  for (int i = 0; i < 3; ++i) sample.position += w[i] * map_->positions[c[i]];
  if (!map_->source_face.empty()) {
    sample.source.face = map_->source_face[t];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) sample.source.weights[k] += w[i] * static_cast<double>(map_->source[t][3 * i + k]);
  }
  return sample;
}

std::vector<double> cell_areas(const PatchMap& map, int n) {
  std::vector<double> areas(static_cast<std::size_t>(n) * n, 0.0);
  ClippedPolygon triangle, low, row, left, cell;
  for (const auto& t : map.triangles) {
    const double total = surface_area(map, t);
    const Vec2 &a = map.uv[t[0]], &b = map.uv[t[1]], &c = map.uv[t[2]];
    const double under = 0.5 * orientation(a, b, c.x(), c.y());
    const int v0 = cell_of(std::min({a.y(), b.y(), c.y()}), n), v1 = cell_of(std::max({a.y(), b.y(), c.y()}), n);
    const int u0 = cell_of(std::min({a.x(), b.x(), c.x()}), n), u1 = cell_of(std::max({a.x(), b.x(), c.x()}), n);
    if ((u0 == u1 && v0 == v1) || !(under > 0)) {
      const Vec2 centre = (a + b + c) / 3;
      areas[static_cast<std::size_t>(cell_of(centre.y(), n)) * n + cell_of(centre.x(), n)] += total;
      continue;
    }
    triangle.points[0] = a, triangle.points[1] = b, triangle.points[2] = c;
    triangle.size = 3;
    for (int v = v0; v <= v1; ++v) {
      clip(triangle, 1, static_cast<double>(v) / n, 1, low);
      clip(low, 1, static_cast<double>(v + 1) / n, -1, row);
      for (int u = u0; u <= u1 && row.size > 2; ++u) {
        clip(row, 0, static_cast<double>(u) / n, 1, left);
        clip(left, 0, static_cast<double>(u + 1) / n, -1, cell);
        areas[static_cast<std::size_t>(v) * n + u] += total * (area(cell) / under);
      }
    }
  }
  return areas;
}

std::array<Vec3, 4> corner_positions(const PatchMap& map) {
  std::array<Vec3, 4> out;
  for (std::size_t v = 0; v < map.uv.size(); ++v)
    for (int i = 0; i < 4; ++i)
      if (map.is_on_side(v, i) && map.is_on_side(v, (i + 3) % 4)) out[i] = map.positions[v];
  return out;
}

const char* find_map_defect(const PatchMap& map) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Point = Kernel::Point_2;
  const int vertices = static_cast<int>(map.uv.size()), triangles = static_cast<int>(map.triangles.size());
  if (triangles == 0) return "map without triangles";
  if (map.positions.size() != map.uv.size()) return "map with a different number of positions and parameters";
  if (map.source_face.size() != map.source.size() || (!map.source_face.empty() && map.source_face.size() != map.triangles.size()))
    return "map with a different number of sources and triangles";
  for (int v = 0; v < vertices; ++v) {
    if (!map.uv[v].allFinite() || !map.positions[v].allFinite()) return "map with a value that is not finite";
    if (map.uv[v].minCoeff() < 0 || map.uv[v].maxCoeff() > 1) return "map with a vertex outside the square";
  }
  for (const auto& t : map.triangles) {
    for (int c : t)
      if (c < 0 || c >= vertices) return "map with a corner out of range";
    const Point a(map.uv[t[0]].x(), map.uv[t[0]].y()), b(map.uv[t[1]].x(), map.uv[t[1]].y()), c(map.uv[t[2]].x(), map.uv[t[2]].y());
    if (CGAL::orientation(a, b, c) != CGAL::LEFT_TURN) return "map with a triangle that is flipped or has no area";
  }
  // Counter-clockwise triangles with one simple boundary loop around the square tile it exactly once.
  const OutgoingHalfEdges outgoing(map);
  std::vector<int> next(vertices, -1);
  int boundary = 0, edges = 0;
  for (int h = 0; h < 3 * triangles; ++h) {
    const int a = map.triangles[h / 3][h % 3], b = map.triangles[h / 3][(h % 3 + 1) % 3];
    int same = 0, across = 0;
    outgoing.find(a, b, &same);
    outgoing.find(b, a, &across);
    if (same != 1 || across > 1) return "map with an edge of more than two triangles";
    if (across == 1) {
      edges += a < b;
      continue;
    }
    ++edges;
    ++boundary;
    if (next[a] >= 0) return "map with a boundary that touches itself";
    next[a] = b;
  }
  for (int v = 0; v < vertices; ++v)
    if (outgoing.valence(v) == 0) return "map with an unused vertex";
  if (vertices - edges + triangles != 1) return "map that is no disk";
  // Once around from (0, 0); `side` is where the last step ran.
  int start = -1;
  for (int v = 0; v < vertices; ++v)
    if (next[v] >= 0 && map.uv[v].x() == 0 && map.uv[v].y() == 0) start = v;
  if (start < 0) return "map without a boundary vertex at the corner (0, 0)";
  int side = 0, v = start, seen = 0;
  while (side < 4) {
    const Vec2 &a = map.uv[v], &b = map.uv[next[v]];
    const int axis = side % 2;
    const double fixed = side == 1 || side == 2 ? 1 : 0, end = side < 2 ? 1 : 0;
    if (a[1 - axis] != fixed || b[1 - axis] != fixed) return "map with a boundary vertex off the sides";
    if (side < 2 ? !(b[axis] > a[axis]) : !(b[axis] < a[axis])) return "map with a side that is not strictly monotone";
    v = next[v];
    if (++seen > boundary) return "map with more than one boundary loop";
    if (map.uv[v][axis] == end) ++side;
  }
  if (v != start || seen != boundary) return "map with more than one boundary loop";
  // A disk may still be pinched in a vertex inside.
  for (int w = 0; w < vertices; ++w) {
    int h = outgoing.outgoing(w, 0), fan = 0;
    const int first = h;
    // Clockwise to the boundary or around, then counter-clockwise.
    do {
      ++fan;
      const int a = map.triangles[h / 3][h % 3], b = map.triangles[h / 3][(h % 3 + 1) % 3];
      const int twin = outgoing.find(b, a);
      h = twin < 0 ? -1 : 3 * (twin / 3) + (twin % 3 + 1) % 3;
    } while (h >= 0 && h != first && fan <= outgoing.valence(w));
    if (h < 0) {
      h = first;
      while (true) {
        const int previous = 3 * (h / 3) + (h % 3 + 2) % 3;
        const int a = map.triangles[previous / 3][previous % 3];
        const int twin = outgoing.find(w, a);
        if (twin < 0) break;
        h = twin;
        if (++fan > outgoing.valence(w)) break;
      }
    }
    if (fan != outgoing.valence(w)) return "map that is pinched in a vertex";
  }
  return "";
}

}  // namespace hybrid_mesh
