// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/crossing_faces.h"

#include <algorithm>
#include <array>

#include "decoder/disjoint_sets.h"
#include "remesh/quality.h"
#include "surface/closest_point.h"
#include "surface/self_intersections.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {
namespace {

Vec3 middle_of(const std::vector<Vec3>& polygon) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : polygon) sum += p;
  return sum / static_cast<double>(polygon.size());
}

// Of some of a mesh's faces, as triangles.
CrossingFaces crossing(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& triangles, const std::vector<int>& face_of,
                       const Progress& progress) {
  CrossingFaces pairs;
  for (const SelfIntersection& s : find_self_intersections(points, triangles, progress)) {
    const std::pair<int, int> faces = std::minmax(face_of[s.faces[0]], face_of[s.faces[1]]);
    if (faces.first != faces.second) pairs.insert({faces, middle_of(s.common)});
  }
  return pairs;
}

// A quad that runs through another is as bad as so many that are inverted, which the next fit may mend.
constexpr std::size_t kWorse = 4;

// What part of their way from `before` vertices go, tried out step by step.
class TakingBack {
 public:
  TakingBack(QuadMesh& mesh, const std::vector<Vec3>& before, const CrossingFilter& filter, const Progress& progress)
      : mesh_(mesh), before_(before), after_(mesh.points), filter_(filter), progress_(progress), moved_(before.size(), 0) {}

  TakenBack run() {
    // The first ones take the least that is needed; at last vertices are where they were, until what crosses there crossed before.
    constexpr std::array<double, 6> shorter{0.6, 0.6, 0.6, 0.6, 0.5, 0.5};
    constexpr std::size_t most_steps = 16;
    std::vector<double> part(before_.size(), 1);
    CrossingFaces pairs = filtered(crossing_faces(mesh_, progress_));
    if (pairs.empty()) return {};
    const auto keep = [&] {
      steps_.push_back({part, pairs, inverted_quads(mesh_)});
      for (const int v : around(pairs)) moved_[v] = 1;
    };
    keep();
    for (std::size_t k = 0; k < most_steps && !pairs.empty(); ++k) {
      bool any = false;
      for (const int v : around(pairs)) {
        any |= part[v] > 0;
        part[v] *= k < shorter.size() ? shorter[k] : 0;
      }
      if (!any) break;
      place(part);
      pairs = crossing_near_moved();
      keep();
    }
    // Knots that never crossed as far as both went may do so now.
    part = best_of_each_knot();
    place(part);
    pairs = crossing_near_moved();
    keep();
    const auto best = std::min_element(steps_.begin(), steps_.end(), [&](const Step& a, const Step& b) { return badness(a) < badness(b); });
    place(best->part);
    return {true, badness(*best)};
  }

 private:
  struct Step {
    std::vector<double> part;  // per vertex: of its way
    CrossingFaces pairs;
    std::vector<int> inverted;
  };

  static std::size_t badness(const Step& step) { return kWorse * step.pairs.size() + step.inverted.size(); }

  void place(const std::vector<double>& part) {
    for (std::size_t v = 0; v < part.size(); ++v) mesh_.points[v] = part[v] == 1 ? after_[v] : Vec3(before_[v] + part[v] * (after_[v] - before_[v]));
  }

  // The vertices of the faces that cross, and of all faces around these.
  std::vector<int> around(const CrossingFaces& pairs) const {
    std::vector<char> on(before_.size(), 0), near(before_.size(), 0);
    for (const auto& [faces, place] : pairs)
      for (const int f : {faces.first, faces.second}) mesh_.for_corners(f, [&](int v) { on[v] = 1; });
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      bool touches = false;
      mesh_.for_corners(f, [&](int v) { touches |= on[v] != 0; });
      if (touches) mesh_.for_corners(f, [&](int v) { near[v] = 1; });
    }
    std::vector<int> vertices;
    for (std::size_t v = 0; v < near.size(); ++v)
      if (near[v]) vertices.push_back(static_cast<int>(v));
    return vertices;
  }

  int moved_vertex(int f) const {
    int moved = -1;
    mesh_.for_corners(f, [&](int v) { moved = moved_[v] ? v : moved; });
    return moved;
  }

  // Faces that have not moved cross none that has not either: all of those have.
  CrossingFaces crossing_near_moved() const {
    const Triangulation all = triangulate(to_soup(mesh_));
    std::vector<char> wanted(all.triangles.size(), 0);
    const SurfaceDistanceQuery query(mesh_.points, all.triangles);
    std::vector<int> near;
    for (std::size_t t = 0; t < all.triangles.size(); ++t) {
      const auto& corners = all.triangles[t];
      if (std::none_of(corners.begin(), corners.end(), [&](int v) { return moved_[v] != 0; })) continue;
      Vec3 low = mesh_.points[corners[0]], high = low;
      for (const int v : corners) low = low.cwiseMin(mesh_.points[v]), high = high.cwiseMax(mesh_.points[v]);
      query.faces_in_box(low, high, all.triangles.size(), near);
      for (const int other : near) wanted[other] = 1;
    }
    std::vector<std::array<int, 3>> triangles;
    std::vector<int> face_of;
    for (std::size_t t = 0; t < wanted.size(); ++t)
      if (wanted[t]) triangles.push_back(all.triangles[t]), face_of.push_back(static_cast<int>(all.polygon[t]));
    return filtered(crossing(mesh_.points, triangles, face_of, progress_));
  }

  CrossingFaces filtered(CrossingFaces pairs) const {
    if (filter_) filter_(mesh_, pairs);
    return pairs;
  }

  // Vertices that have moved belong together if a face, or two that cross in some step, have them.
  DisjointSets knots() const {
    DisjointSets sets(before_.size());
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      const int moved = moved_vertex(static_cast<int>(f));
      if (moved >= 0)
        mesh_.for_corners(f, [&](int v) {
          if (moved_[v]) sets.join(moved, v);
        });
    }
    for (const Step& step : steps_)
      for (const auto& [faces, place] : step.pairs) sets.join(moved_vertex(faces.first), moved_vertex(faces.second));
    return sets;
  }

  std::vector<double> best_of_each_knot() const {
    DisjointSets sets = knots();
    std::map<int, std::vector<std::size_t>> bad;  // of each knot, per step
    for (std::size_t k = 0; k < steps_.size(); ++k) {
      const auto count = [&](int f, std::size_t weight) {
        const int v = moved_vertex(f);
        if (v >= 0) bad.try_emplace(sets.find(v), std::vector<std::size_t>(steps_.size(), 0)).first->second[k] += weight;
      };
      for (const auto& [faces, place] : steps_[k].pairs) count(faces.first, kWorse);
      for (const int f : steps_[k].inverted) count(f, 1);
    }
    std::vector<double> part(before_.size(), 1);
    for (std::size_t v = 0; v < part.size(); ++v) {
      if (!moved_[v]) continue;
      const std::vector<std::size_t>& of_knot = bad.at(sets.find(static_cast<int>(v)));
      part[v] = steps_[std::min_element(of_knot.begin(), of_knot.end()) - of_knot.begin()].part[v];
    }
    return part;
  }

  QuadMesh& mesh_;
  const std::vector<Vec3>& before_;
  const std::vector<Vec3> after_;
  const CrossingFilter& filter_;
  const Progress& progress_;
  std::vector<char> moved_;
  std::vector<Step> steps_;
};

}  // namespace

CrossingFaces crossing_faces(const QuadMesh& mesh, const Progress& progress) {
  const Triangulation t = triangulate(to_soup(mesh));
  return crossing(mesh.points, t.triangles, {t.polygon.begin(), t.polygon.end()}, progress);
}

TakenBack take_back_crossings(QuadMesh& mesh, const std::vector<Vec3>& before, const CrossingFilter& filter, const Progress& progress) {
  return TakingBack(mesh, before, filter, progress).run();
}

}  // namespace hybrid_mesh
