// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/feature_graph.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "decoder/disjoint_sets.h"
#include "surface/boundary_loop.h"

namespace hybrid_mesh {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

class FeatureSearch {
 public:
  FeatureSearch(const TriangleSurface& surface, const FeatureOptions& options)
      : s_(surface), options_(options), angle_(surface.opposite.size(), 0), on_(surface.opposite.size(), 0), around_(surface.points.size()) {
    std::vector<Vec3> normals;
    for (const auto& f : s_.faces) normals.push_back((s_.points[f[1]] - s_.points[f[0]]).cross(s_.points[f[2]] - s_.points[f[0]]).normalized());
    for (int h = 0; h < static_cast<int>(angle_.size()); ++h)
      if (const int o = s_.opposite[h]; o >= 0)
        angle_[h] = std::atan2(normals[h / 3].cross(normals[o / 3]).norm(), normals[h / 3].dot(normals[o / 3])) / kDegree;
  }

  std::vector<char> run() {
    grow();
    drop_stubs();
    double kept = 0, left = 0;
    for (int h = 0; h < static_cast<int>(angle_.size()); ++h) {
      if (s_.opposite[h] < h) continue;
      if (on_[h])
        kept += length(h);
      else if (angle_[h] >= options_.weak_angle)
        left += length(h);
    }
    if (left > options_.most_left * kept || kept < options_.least_total * std::sqrt(surface_area(s_))) return {};
    return on_;
  }

 private:
  double length(int h) const { return (s_.points[s_.to(h)] - s_.points[s_.from(h)]).norm(); }

  bool is_crisp(int h) const {
    const auto beside = [&](int g) { return std::min(angle_[TriangleSurface::next(g)], angle_[TriangleSurface::previous(g)]); };
    return angle_[h] >= options_.crispness * std::max(beside(h), beside(s_.opposite[h]));
  }
  void set(int h, bool on) {
    on_[h] = on_[s_.opposite[h]] = on;
    for (const int v : {s_.from(h), s_.to(h)}) {
      if (on)
        around_[v].push_back(h);
      else
        std::erase(around_[v], h);
    }
  }
  int other_end(int h, int v) const { return s_.from(h) == v ? s_.to(h) : s_.from(h); }

  // From the sharp edges along those that are nearly so.
  void grow() {
    std::vector<std::vector<int>> weak(s_.points.size());
    std::vector<int> stack;
    for (int h = 0; h < static_cast<int>(angle_.size()); ++h) {
      if (s_.opposite[h] < h || angle_[h] < options_.weak_angle || !is_crisp(h)) continue;
      weak[s_.from(h)].push_back(h), weak[s_.to(h)].push_back(h);
      if (angle_[h] >= options_.angle) stack.push_back(h);
    }
    for (const int h : stack) set(h, true);
    while (!stack.empty()) {
      const int h = stack.back();
      stack.pop_back();
      for (const int v : {s_.from(h), s_.to(h)})
        for (const int g : weak[v])
          if (!on_[g]) set(g, true), stack.push_back(g);
    }
  }

  // The chain of edges from a vertex on, up to where it ends or branches, or to its start again.
  std::vector<int> chain(int v, int h) const {
    std::vector<int> edges{h};
    for (int w = other_end(h, v); around_[w].size() == 2 && w != v; w = other_end(h, w)) {
      h = around_[w][0] == h ? around_[w][1] : around_[w][0];
      edges.push_back(h);
    }
    return edges;
  }
  double length(const std::vector<int>& edges) const {
    return std::accumulate(edges.begin(), edges.end(), 0.0, [&](double sum, int h) { return sum + length(h); });
  }

  void drop_stubs() {
    std::vector<char> boundary(s_.points.size(), 0);
    for (int h = 0; h < static_cast<int>(s_.opposite.size()); ++h)
      if (s_.opposite[h] < 0) boundary[s_.from(h)] = 1;
    for (bool any = true; any;) {
      any = false;
      for (int v = 0; v < static_cast<int>(around_.size()); ++v) {
        if (around_[v].size() != 1 || boundary[v]) continue;
        const std::vector<int> stub = chain(v, around_[v][0]);
        if (length(stub) >= options_.least_length) continue;
        for (const int h : stub) set(h, false);
        any = true;
      }
    }
    std::vector<char> seen(s_.opposite.size(), 0);
    for (int v = 0; v < static_cast<int>(around_.size()); ++v) {
      if (around_[v].size() != 2 || seen[around_[v][0]]) continue;
      const std::vector<int> loop = chain(v, around_[v][0]);
      for (const int h : loop) seen[h] = 1;
      const int last = loop.back();
      const bool closed = loop.size() > 1 && (s_.from(last) == v || s_.to(last) == v);
      if (closed && length(loop) < options_.least_length)
        for (const int h : loop) set(h, false);
    }
  }

  const TriangleSurface& s_;
  const FeatureOptions& options_;
  std::vector<double> angle_;             // per half-edge, degrees
  std::vector<char> on_;                  // per half-edge
  std::vector<std::vector<int>> around_;  // per point: one half-edge of each feature edge there
};

}  // namespace

namespace {

// In degrees.
double turn(const Vec3& before, const Vec3& at, const Vec3& after) {
  const Vec3 a = at - before, b = after - at;
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

// Marks the boundary loops that are straight between their corners, as a plate's are and a scan's are not.
void mark_polygons(const TriangleSurface& s, const FeatureOptions& options, std::vector<char>& edges) {
  std::vector<char> on(s.points.size(), 0);
  double length = 0;
  for (const BoundaryLoop& loop : boundary_loops(s)) {
    const int n = loop.size();
    std::vector<double> turns(n);
    for (int i = 0; i < n; ++i) turns[i] = turn(loop.point(i + n - 1), loop.point(i), loop.point(i + 1));
    // From a vertex on in one direction, up to where the loop turns.
    const auto is_straight = [&](int i, int step) {
      double along = 0;
      int j = i;
      do {
        const int next = (j + step + n) % n;
        along += (loop.point(next) - loop.point(j)).norm();
        j = next;
      } while (along < options.least_length && turns[j] < options.weak_angle);
      return along >= options.least_length;
    };
    double corners = 0, left = 0;
    for (int i = 0; i < n; ++i) {
      if (turns[i] > options.corner_angle && is_straight(i, 1) && is_straight(i, -1))
        corners += turns[i];
      else if (turns[i] >= options.weak_angle)
        left += turns[i];
    }
    if (corners == 0 || left > options.most_left * corners) continue;
    for (int i = 0; i < n; ++i) on[loop.vertex(i)] = 1;
    length += loop.length();
  }
  if (length == 0 || length < options.least_total * std::sqrt(surface_area(s))) return;
  edges.resize(s.opposite.size());
  for (int h = 0; h < static_cast<int>(s.opposite.size()); ++h)
    if (s.opposite[h] < 0 && on[s.from(h)]) edges[h] = 1;
}

}  // namespace

FeatureGraph find_features(const TriangleSurface& surface, const FeatureOptions& options) {
  std::vector<char> edges = FeatureSearch(surface, options).run();
  if (options.polygons) mark_polygons(surface, options, edges);
  return feature_graph(surface, std::move(edges), options.corner_angle);
}

FeatureGraph feature_graph(const TriangleSurface& surface, std::vector<char> edges, double corner_angle) {
  FeatureGraph graph;
  if (std::none_of(edges.begin(), edges.end(), [](char on) { return on; })) return graph;
  graph.corners.assign(surface.points.size(), 0);
  std::vector<std::vector<int>> ends(surface.points.size());  // of inner edges
  std::vector<int> before(surface.points.size(), -1);         // along the boundary
  const int count = static_cast<int>(surface.opposite.size());
  for (int h = 0; h < count; ++h) {
    if (surface.opposite[h] < 0)
      before[surface.to(h)] = surface.from(h);
    else if (edges[h])
      ends[surface.from(h)].push_back(surface.to(h));
  }
  const auto turns = [&](int a, int v, int b) { return turn(surface.points[a], surface.points[v], surface.points[b]) > corner_angle; };
  for (int v = 0; v < static_cast<int>(ends.size()); ++v)
    if (!ends[v].empty()) graph.corners[v] = ends[v].size() != 2 || before[v] >= 0 || turns(ends[v][0], v, ends[v][1]);
  for (int h = 0; h < count; ++h) {
    if (surface.opposite[h] >= 0 || !edges[h]) continue;
    const int v = surface.from(h);
    graph.corners[v] |= turns(before[v], v, surface.to(h));
  }
  graph.edges = std::move(edges);
  return graph;
}

FeatureGraph with_boundary(const TriangleSurface& surface, const FeatureGraph& graph, double corner_angle) {
  std::vector<char> edges = graph.edges;
  edges.resize(surface.opposite.size());
  for (std::size_t h = 0; h < edges.size(); ++h) edges[h] |= surface.opposite[h] < 0;
  FeatureGraph all = feature_graph(surface, std::move(edges), corner_angle);
  all.corners.resize(surface.points.size());
  for (std::size_t v = 0; v < graph.corners.size(); ++v) all.corners[v] |= graph.corners[v];
  return all;
}

std::vector<int> curve_components(const TriangleSurface& surface, const std::vector<char>& feature_edges) {
  DisjointSets sets(surface.points.size());
  std::vector<char> on(surface.points.size(), 0);
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h)
    if (surface.opposite[h] < 0 || (!feature_edges.empty() && feature_edges[h])) {
      sets.join(surface.from(h), surface.to(h));
      on[surface.from(h)] = on[surface.to(h)] = 1;
    }
  std::vector<int> component(surface.points.size(), -1);
  for (std::size_t v = 0; v < on.size(); ++v)
    if (on[v]) component[v] = sets.find(static_cast<int>(v));
  return component;
}

}  // namespace hybrid_mesh
