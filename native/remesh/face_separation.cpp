// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/face_separation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <set>

#include "remesh/quality.h"

namespace hybrid_mesh {
namespace {

// Moves single vertices out of faces that run through others.
class Separation {
 public:
  Separation(QuadMesh& mesh, const std::vector<char>& fixed, const std::vector<Vec3>& before, const CrossingFilter& filter, CrossingGuard& guard)
      : mesh_(mesh), start_(mesh.points), fixed_(fixed), before_(before), filter_(filter), guard_(guard) {}

  void run(const Progress& progress) {
    constexpr int sweeps = 8;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      CrossingFaces pairs = crossing_faces(mesh_, progress);
      if (filter_) filter_(mesh_, pairs);
      std::set<int> vertices;
      for (const auto& [faces, place] : pairs)
        for (const int f : {faces.first, faces.second}) mesh_.for_corners(f, [&](int v) { vertices.insert(v); });
      bool any = false;
      for (const int v : vertices) {
        progress.check();
        if (!fixed_[v]) any |= move(v);
      }
      if (!any) return;
    }
  }

 private:
  // Where a vertex may go: towards the middle of its neighbours, back to where it came from, and off the surface.
  std::vector<Vec3> places(int v) const {
    const Vec3 p = mesh_.points[v];
    Vec3 normal = Vec3::Zero(), sum = Vec3::Zero();
    double shortest = std::numeric_limits<double>::infinity();
    int count = 0;
    for (const int f : guard_.faces_at(v)) {
      const std::int64_t begin = mesh_.offsets[f];
      const int n = static_cast<int>(mesh_.offsets[f + 1] - begin);
      for (int i = 0; i < n; ++i) {
        if (mesh_.indices[begin + i] != v) continue;
        const Vec3 &next = mesh_.points[mesh_.indices[begin + (i + 1) % n]], &previous = mesh_.points[mesh_.indices[begin + (i + n - 1) % n]];
        normal += (next - p).cross(previous - p);
        sum += next + previous;
        count += 2;
        shortest = std::min({shortest, (next - p).norm(), (previous - p).norm()});
      }
    }
    std::vector<Vec3> out;
    for (const double part : {0.25, 0.5, 1.0}) out.push_back(p + part * (sum / count - p));
    for (const double part : {0.02, -0.02, 0.06, -0.06, 0.15, -0.15}) out.push_back(p + part * shortest * normal.normalized());
    // What is not on its way to the surface stays close to it.
    const Vec3& home = start_[v];
    std::erase_if(out, [&](const Vec3& place) { return (place - home).norm() > kReach * shortest; });
    for (const double part : {0.25, 0.5, 1.0}) out.push_back(p + part * (before_[v] - p));
    return out;
  }

  // The least scaled Jacobian of the quads at a vertex.
  double worst_quad(int v) const {
    double worst = 1;
    for (const int f : guard_.faces_at(v))
      if (mesh_.offsets[f + 1] - mesh_.offsets[f] == 4) worst = std::min(worst, scaled_jacobian(mesh_, f));
    return worst;
  }

  bool move(int v) {
    constexpr double unfolded = 0.05;  // of a scaled Jacobian: one that is less does not become still less
    const Vec3 here = mesh_.points[v];
    const int crossings = guard_.crossings(v, here);
    if (crossings == 0) return false;
    const double enough = std::min(worst_quad(v), unfolded);
    Vec3 best = here;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& place : places(v)) {
      const double way = (place - here).norm();
      if (way >= least) continue;
      mesh_.points[v] = place;
      if (worst_quad(v) >= enough && guard_.crossings(v, place) < crossings) least = way, best = place;
    }
    mesh_.points[v] = best;
    if (best == here) return false;
    guard_.moved(v);
    return true;
  }

  static constexpr double kReach = 0.2;  // of the shortest edge at a vertex

  QuadMesh& mesh_;
  const std::vector<Vec3> start_;
  const std::vector<char>& fixed_;
  const std::vector<Vec3>& before_;
  const CrossingFilter& filter_;
  CrossingGuard& guard_;
};

}  // namespace

void separate_faces(QuadMesh& mesh, const std::vector<char>& fixed, const std::vector<Vec3>& before, const CrossingFilter& filter,
                    CrossingGuard& guard, const Progress& progress) {
  Separation(mesh, fixed, before, filter, guard).run(progress);
}

}  // namespace hybrid_mesh
