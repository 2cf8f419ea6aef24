// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/crossing_guard.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <utility>

#include "surface/triangle_intersection.h"

namespace hybrid_mesh {
namespace {

using Box = Eigen::AlignedBox3d;

// Some of a mesh's faces, with one vertex at another place.
PolygonSoup some_faces(const QuadMesh& mesh, const std::vector<int>& faces, int moved, const Vec3& place) {
  PolygonSoup soup;
  std::vector<int> vertices;
  for (const int f : faces) mesh.for_corners(f, [&](int v) { vertices.push_back(v); });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for (const int v : vertices) soup.points.push_back(v == moved ? place : mesh.points[v]);
  for (const int f : faces) {
    mesh.for_corners(f, [&](int v) {
      soup.indices.push_back(static_cast<std::int32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()));
    });
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  return soup;
}

}  // namespace

CrossingGuard::CrossingGuard(const QuadMesh& mesh)
    : mesh_(mesh),
      faces_at_(mesh.points.size()),
      start_(triangulate(to_soup(mesh))),
      at_start_(mesh.points, start_.triangles),
      moved_at_(mesh.face_count(), -1) {
  for (int f = 0; f < static_cast<int>(mesh.face_count()); ++f) mesh.for_corners(f, [&](int v) { faces_at_[v].push_back(f); });
}

int CrossingGuard::crossings(int v, const Vec3& place) const {
  const std::vector<int>& own = faces_at_[v];
  Box box;
  for (const int f : own) mesh_.for_corners(f, [&](int w) { box.extend(w == v ? place : mesh_.points[w]); });
  std::vector<int> faces = own;
  for (const int f : faces_in_box(box))
    if (std::find(own.begin(), own.end(), f) == own.end()) faces.push_back(f);
  const PolygonSoup soup = some_faces(mesh_, faces, v, place);
  const Triangulation split = triangulate(soup);
  std::vector<Box> boxes(split.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t)
    for (const int w : split.triangles[t]) boxes[t].extend(soup.points[w]);
  const auto corners = [&](std::size_t t) {
    const auto& c = split.triangles[t];
    return TriangleCorners{&soup.points[c[0]], &soup.points[c[1]], &soup.points[c[2]]};
  };
  // The faces at the vertex are the first.
  std::set<std::pair<int, int>> pairs;
  for (std::size_t a = 0; a < boxes.size() && split.polygon[a] < static_cast<int>(own.size()); ++a)
    for (std::size_t b = a + 1; b < boxes.size(); ++b)
      if (split.polygon[a] != split.polygon[b] && boxes[a].intersects(boxes[b]) && triangles_meet(corners(a), corners(b)))
        pairs.insert({split.polygon[a], split.polygon[b]});
  return static_cast<int>(pairs.size());
}

bool CrossingGuard::allows(int v, const Vec3& place) const {
  const int there = crossings(v, place);
  return there == 0 || there <= crossings(v, mesh_.points[v]);
}

void CrossingGuard::moved(int v) {
  for (const int f : faces_at_[v]) {
    if (moved_at_[f] < 0) {
      moved_at_[f] = static_cast<int>(moved_faces_.size());
      moved_faces_.push_back({f, {}});
    }
    moved_faces_[moved_at_[f]].box = box_of(f);
  }
}

Box CrossingGuard::box_of(int face) const {
  Box box;
  mesh_.for_corners(face, [&](int v) { box.extend(mesh_.points[v]); });
  return box;
}

std::vector<int> CrossingGuard::faces_in_box(const Eigen::AlignedBox3d& box) const {
  std::vector<int> near, faces;
  at_start_.faces_in_box(box.min(), box.max(), start_.triangles.size(), near);
  for (const int t : near)
    if (const int f = start_.polygon[t]; moved_at_[f] < 0) faces.push_back(f);
  for (const MovedFace& moved : moved_faces_)
    if (box.intersects(moved.box)) faces.push_back(moved.face);
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

}  // namespace hybrid_mesh
