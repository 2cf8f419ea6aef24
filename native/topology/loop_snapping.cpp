// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <string>
#include <unordered_map>

#include "base/error.h"
#include "surface/closest_point.h"
#include "topology/loop_graph.h"
#include "topology/surface_loops.h"

namespace hybrid_mesh {
namespace {

// Of the way from one place of the stroke to the next, and the lengths of edges there: a way on the surface that is longer leaves the stroke.
constexpr double longest_detour = 8;

class LoopSnapper {
 public:
  LoopSnapper(const TriangleSurface& surface, const Progress& progress)
      : surface_(surface), query_(surface, progress.part(0, 0.5)), graph_(surface, progress.part(0.5, 1)), search_(graph_) {}
  std::vector<int> snap(const std::vector<Vec3>& stroke, SnapTightening tightening, const Progress& progress);

 private:
  std::vector<int> walk_along(const std::vector<Vec3>& stroke, const Progress& progress);
  int nearest_point(const Vec3& place) const;
  double edge_length(int v) const;
  std::vector<int> simple_cycle(const std::vector<int>& walk) const;
  std::vector<int> tightened(std::vector<int> loop, const Progress& progress);

  const TriangleSurface& surface_;
  SurfaceDistanceQuery query_;
  LoopGraph graph_;
  LoopSearch search_;
};

double LoopSnapper::edge_length(int v) const {
  double longest = 0;
  for (const LoopGraph::Arc* arc = graph_.begin(v); arc != graph_.end(v); ++arc) longest = std::max(longest, arc->length);
  return longest;
}

// Of the face that is nearest, the nearest corner inside; beside a boundary, the nearest point inside that is a few edges away.
int LoopSnapper::nearest_point(const Vec3& place) const {
  const auto& face = surface_.faces[query_.closest(place).face];
  std::vector<int> near(face.begin(), face.end());
  constexpr int rings = 3;
  for (int ring = 0; ring <= rings; ++ring) {
    int best = -1;
    for (const int v : near)
      if (!graph_.wall(v) && (best < 0 || (surface_.points[v] - place).squaredNorm() < (surface_.points[best] - place).squaredNorm())) best = v;
    if (best >= 0) return best;
    const std::vector<int> inner = near;
    for (const int v : inner)
      for (const LoopGraph::Arc* arc = graph_.begin(v); arc != graph_.end(v); ++arc) near.push_back(arc->to);
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }
  throw NoMap("there is no way beside the boundary for the loop");
}

// The points nearest to places on the stroke, about an edge apart, joined by shortest paths: closed, and it may meet itself.
std::vector<int> LoopSnapper::walk_along(const std::vector<Vec3>& stroke, const Progress& progress) {
  std::vector<Vec3> places;
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    const Vec3 &a = stroke[i], &b = stroke[(i + 1) % stroke.size()];
    constexpr double most_places = 10000;
    const double step = edge_length(nearest_point(a)) / 2;
    const int count = std::max(1, static_cast<int>(std::min(most_places, step > 0 ? std::ceil((b - a).norm() / step) : 1)));
    for (int k = 0; k < count; ++k) places.push_back(a + (b - a) * k / count);
    progress.check();
  }
  std::vector<int> walk;
  const int first = nearest_point(places[0]);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3& next_place = places[(i + 1) % places.size()];
    const int from = walk.empty() ? first : walk.back(), to = i + 1 == places.size() ? first : nearest_point(next_place);
    if (walk.empty()) walk.push_back(from);
    const double bound =
        longest_detour * ((next_place - places[i]).norm() + (surface_.points[from] - surface_.points[to]).norm() + edge_length(from));
    const std::vector<int> path = search_.path(from, to, bound, progress);
    if (path.empty()) {
      const Vec3& at = places[i];
      throw NoMap("the loop leaves the surface near (" + std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " + std::to_string(at.z()) +
                  ")");
    }
    walk.insert(walk.end(), path.begin() + 1, path.end());
  }
  walk.pop_back();  // the first point again
  return walk;
}

// Wherever the walk comes back to a point, either what it has done since or the rest is left out.
std::vector<int> LoopSnapper::simple_cycle(const std::vector<int>& walk) const {
  const std::uint64_t whole = search_.key_of(walk);
  const double whole_length = search_.length_of(walk);
  std::vector<int> cycle;
  std::unordered_map<int, std::size_t> place;
  for (const int v : walk) {
    const auto met = place.find(v);
    if (met == place.end()) {
      place[v] = cycle.size();
      cycle.push_back(v);
      continue;
    }
    const std::vector<int> since(cycle.begin() + static_cast<std::ptrdiff_t>(met->second), cycle.end());
    const std::uint64_t key = search_.key_of(since);
    const bool keep = since.size() >= 3 && (whole != 0 ? key == whole : key == 0 && 2 * search_.length_of(since) > whole_length);
    if (keep) return since;
    for (std::size_t i = met->second + 1; i < cycle.size(); ++i) place.erase(cycle[i]);
    cycle.resize(met->second + 1);
  }
  return cycle;
}

std::vector<int> LoopSnapper::tightened(std::vector<int> loop, const Progress& progress) {
  const std::uint64_t key = search_.key_of(loop);
  if (key == 0) return loop;
  double length = search_.length_of(loop);
  constexpr std::size_t bases = 8;
  constexpr int rounds = 40;
  for (int round = 0, vain = 0; round < rounds && vain < 2; ++round) {
    bool shorter = false;
    for (std::size_t k = 0; k < bases; ++k) {
      const std::vector<int> other = search_.shortest(loop[(2 * k + round % 2) * loop.size() / (2 * bases)], length * (1 - 1e-9), progress, key);
      if (other.empty()) continue;
      loop = other;
      length = search_.length_of(loop);
      shorter = true;
    }
    vain = shorter ? 0 : vain + 1;
  }
  return loop;
}

std::vector<int> LoopSnapper::snap(const std::vector<Vec3>& stroke, SnapTightening tightening, const Progress& progress) {
  std::vector<int> loop = simple_cycle(walk_along(stroke, progress));
  if (loop.size() < 3) throw NoMap("the loop is smaller than a triangle of the surface");
  return tightening == SnapTightening::None ? loop : tightened(std::move(loop), progress);
}

}  // namespace

std::vector<Found<std::vector<int>>> snap_loops(const TriangleSurface& surface, const std::vector<LoopStroke>& strokes, const Progress& progress) {
  progress.check();
  for (const LoopStroke& stroke : strokes) {
    if (stroke.points.size() < 2) throw Error(ErrorCode::InvalidInput, "a loop has fewer than two points");
    for (const Vec3& p : stroke.points)
      if (!p.allFinite()) throw Error(ErrorCode::InvalidInput, "a loop has a point that is not finite");
  }
  std::vector<Found<std::vector<int>>> loops;
  if (strokes.empty()) return loops;
  LoopSnapper snapper(surface, progress);
  for (const LoopStroke& stroke : strokes) loops.push_back(found([&] { return snapper.snap(stroke.points, stroke.tightening, progress); }));
  return loops;
}

Found<std::vector<int>> snap_loop(const TriangleSurface& surface, const std::vector<Vec3>& stroke, SnapTightening tightening,
                                  const Progress& progress) {
  // One of many steps of its caller's, who tells how far they are.
  return snap_loops(surface, {{stroke, tightening}}, progress.part(0, 0)).front();
}

}  // namespace hybrid_mesh
