// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/mesh_intersections.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/tolerances.h"
#include "surface/self_intersections.h"
#include "surface/triangle_intersection.h"

namespace hybrid_mesh {
namespace {

struct Box {
  Vec3 low, high;

  // Has a convex polygon a point in it?
  bool meets(std::vector<Vec3> polygon) const {
    for (int i = 0; i < 3; ++i) {
      polygon = clipped(polygon, Vec3::Unit(i), low);
      polygon = clipped(polygon, -Vec3::Unit(i), high);
    }
    return !polygon.empty();
  }
};

// Of two faces, where the input stands: placed elsewhere its own points would be rounded, and what touches might not any more. The faces' are, so the
// box is a little larger.
Box box_of(const QuadMesh& mesh, const std::pair<int, int>& faces, const Placement& placement) {
  const Vec3& first = mesh.points[mesh.indices[mesh.offsets[faces.first]]];
  Box box{first, first};
  for (const int f : {faces.first, faces.second})
    for (std::int64_t c = mesh.offsets[f]; c < mesh.offsets[f + 1]; ++c) {
      const Vec3& p = mesh.points[mesh.indices[c]];
      box = {box.low.cwiseMin(p), box.high.cwiseMax(p)};
    }
  const Vec3 rounding = Vec3::Constant(tolerance::same_place);
  return {placement.from_unit(box.low - rounding), placement.from_unit(box.high + rounding)};
}

// What pairs of faces of a surface have in common, of the faces that some boxes meet.
std::vector<std::vector<Vec3>> common_near(const TriangleSurface& surface, const SurfaceDistanceQuery& query, const std::vector<Box>& boxes,
                                           const Progress& progress) {
  std::vector<int> near, in_box;
  for (const Box& box : boxes) {
    progress.check();
    query.faces_in_box(box.low, box.high, surface.faces.size(), in_box);
    near.insert(near.end(), in_box.begin(), in_box.end());
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::vector<std::array<int, 3>> faces;
  for (const int f : near) faces.push_back(surface.faces[f]);
  std::vector<std::vector<Vec3>> common;
  for (SelfIntersection& s : find_self_intersections(surface.points, faces, progress)) common.push_back(std::move(s.common));
  return common;
}

// Of each box: has one of the polygons a point in it?
std::vector<char> boxes_met(const std::vector<Box>& boxes, const std::vector<std::vector<Vec3>>& polygons, const Progress& progress) {
  std::vector<char> met(boxes.size(), 0);
  if (polygons.empty()) return met;
  // Their boxes, as triangles without area between two opposite corners.
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> faces;
  for (const std::vector<Vec3>& polygon : polygons) {
    Vec3 low = polygon.front(), high = low;
    for (const Vec3& p : polygon) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const int at = static_cast<int>(points.size());
    points.insert(points.end(), {low, high});
    faces.push_back({at, at + 1, at + 1});
  }
  const SurfaceDistanceQuery query(points, faces);
  std::vector<int> near;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    progress.check();
    query.faces_in_box(boxes[b].low, boxes[b].high, faces.size(), near);
    met[b] = std::any_of(near.begin(), near.end(), [&](int i) { return boxes[b].meets(polygons[i]); });
  }
  return met;
}

}  // namespace

SurfaceCrossings::SurfaceCrossings(const PlacedSurface& surface, const Progress& progress) : surface_(surface), query_(*surface.surface, progress) {}

std::vector<char> SurfaceCrossings::at(const QuadMesh& mesh, const CrossingFaces& pairs, const Progress& progress) const {
  std::vector<Box> boxes;
  for (const auto& [faces, place] : pairs) boxes.push_back(box_of(mesh, faces, surface_.placement));
  return boxes_met(boxes, common_near(*surface_.surface, query_, boxes, progress), progress);
}

MeshIntersections mesh_intersections(const QuadMesh& mesh, const PlacedSurface& surface, const Progress& progress) {
  const CrossingFaces pairs = crossing_faces(mesh, progress.part(0, 0.7));
  std::vector<char> in_surface;
  if (!pairs.empty()) in_surface = SurfaceCrossings(surface, progress.part(0.7, 0.8)).at(mesh, pairs, progress.part(0.8, 1));
  MeshIntersections found;
  std::size_t at = 0;
  for (const auto& [faces, place] : pairs) {
    if (in_surface[at++]) {
      ++found.pairs_of_input;
    } else {
      ++found.pairs;
      if (!found.where) found.where = place;
    }
  }
  progress(1);
  return found;
}

}  // namespace hybrid_mesh
