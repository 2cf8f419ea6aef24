// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/crossing_guard.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "remesh/quality.h"
#include "surface/triangle_intersection.h"

namespace hybrid_mesh {
namespace {

struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;

  void add(const Vec3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  bool meets(const Box& o) const { return (low.array() <= o.high.array()).all() && (o.low.array() <= high.array()).all(); }
};

template <class Body>
void for_corners(const QuadMesh& mesh, int f, const Body& body) {
  for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) body(mesh.indices[i]);
}

// Some of a mesh's faces, with one vertex at another place.
PolygonSoup some_faces(const QuadMesh& mesh, const std::vector<int>& faces, int moved, const Vec3& place) {
  PolygonSoup soup;
  std::vector<int> vertices;
  for (const int f : faces) for_corners(mesh, f, [&](int v) { vertices.push_back(v); });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const int v : vertices) soup.points.push_back(v == moved ? place : mesh.points[v]);
  for (const int f : faces) {
    for_corners(mesh, f, [&](int v) {
      soup.indices.push_back(static_cast<std::int32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()));
    });
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  return soup;
}

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
        for (const int f : {faces.first, faces.second}) for_corners(mesh_, f, [&](int v) { vertices.insert(v); });
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
    const int crossings = guard_.crossings(v, mesh_.points[v]);
    if (crossings == 0) return false;
    const Vec3 start = mesh_.points[v];
    const double enough = std::min(worst_quad(v), unfolded);
    Vec3 best = start;
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& place : places(v)) {
      const double way = (place - start).norm();
      if (way >= least) continue;
      mesh_.points[v] = place;
      if (worst_quad(v) >= enough && guard_.crossings(v, place) < crossings) least = way, best = place;
    }
    mesh_.points[v] = best;
    if (best == start) return false;
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

CrossingGuard::CrossingGuard(const QuadMesh& mesh)
    : mesh_(mesh),
      faces_at_(mesh.points.size()),
      start_(triangulate(to_soup(mesh))),
      at_start_(mesh.points, start_.triangles),
      has_moved_(mesh.face_count(), 0) {
  for (int f = 0; f < static_cast<int>(mesh.face_count()); ++f) for_corners(mesh, f, [&](int v) { faces_at_[v].push_back(f); });
}

int CrossingGuard::crossings(int v, const Vec3& place) const {
  const std::vector<int>& own = faces_at_[v];
  Box box;
  for (const int f : own) for_corners(mesh_, f, [&](int w) { box.add(w == v ? place : mesh_.points[w]); });
  std::vector<int> faces = own;
  for (const int f : faces_in_box(box.low, box.high))
    if (std::find(own.begin(), own.end(), f) == own.end()) faces.push_back(f);
  const PolygonSoup soup = some_faces(mesh_, faces, v, place);
  const Triangulation split = triangulate(soup);
  std::vector<Box> boxes(split.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (const int w : split.triangles[t]) boxes[t].add(soup.points[w]);
  const auto corners = [&](std::size_t t) {
    const auto& c = split.triangles[t];
    return TriangleCorners{&soup.points[c[0]], &soup.points[c[1]], &soup.points[c[2]]};
  };
  // The faces at the vertex are the first.
  std::set<std::pair<int, int>> pairs;
  for (std::size_t a = 0; a < boxes.size() && split.polygon[a] < static_cast<int>(own.size()); ++a)
    for (std::size_t b = a + 1; b < boxes.size(); ++b)
      if (split.polygon[a] != split.polygon[b] && boxes[a].meets(boxes[b]) && triangles_meet(corners(a), corners(b)))
        pairs.insert({split.polygon[a], split.polygon[b]});
  return static_cast<int>(pairs.size());
}

void CrossingGuard::moved(int v) {
  for (const int f : faces_at_[v])
    if (!std::exchange(has_moved_[f], 1)) moved_faces_.push_back(f);
}

std::vector<int> CrossingGuard::faces_in_box(const Vec3& low, const Vec3& high) const {
  std::vector<int> near, faces;
  at_start_.faces_in_box(low, high, start_.triangles.size(), near);
  for (const int t : near)
    if (const int f = start_.polygon[t]; !has_moved_[f]) faces.push_back(f);
  const Box box{low, high};
  for (const int f : moved_faces_) {
    Box of_face;
    for_corners(mesh_, f, [&](int w) { of_face.add(mesh_.points[w]); });
    if (box.meets(of_face)) faces.push_back(f);
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

void separate_faces(QuadMesh& mesh, const std::vector<char>& fixed, const std::vector<Vec3>& before, const CrossingFilter& filter,
                    CrossingGuard& guard, const Progress& progress) {
  Separation(mesh, fixed, before, filter, guard).run(progress);
}

}  // namespace hybrid_mesh
