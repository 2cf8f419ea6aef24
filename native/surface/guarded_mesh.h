// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "surface/closest_point.h"
#include "surface/edit_mesh.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

struct GuardOptions {
  double tolerance = 1e-5;  // distance that the surface may move where it may, see release()
  double sharp_angle = 30;  // degrees between the normals of two faces from which their edge is a feature
};

// A triangle mesh whose flips, collapses and splits are done only where they leave the surface within a tolerance of the one it was made from,
// however many there are: each face knows a bound of its distance to that surface, to which an operation adds what it moves; where the bound has run
// out, the distance is measured anew. Curves (boundaries and sharp edges) are held in the same way by the points that were taken out of them.
// Faces are held, until they are released: each remains, whole or in parts, a face of the input.
class GuardedMesh {
 public:
  GuardedMesh(const TriangleSurface& input, const GuardOptions& options);

  const EditMesh& mesh() const { return mesh_; }
  const Vec3& point(int v) const { return points_[v]; }
  int point_count() const { return static_cast<int>(points_.size()); }
  const SurfacePoint& place(int v) const { return place_[v]; }
  int face_count() const { return static_cast<int>(mesh_.alive.size()); }  // dead ones included

  double length(int h) const { return (points_[mesh_.to(h)] - points_[mesh_.from(h)]).norm(); }
  int longest(int f) const;
  int shortest(int f) const;
  // The smallest angle of a face, and the half-edge that leaves its corner.
  double smallest_angle(int f) const { return corner_angle(smallest_corner(f)); }
  int smallest_corner(int f) const { return EditMesh::prev(shortest(f)); }
  double corner_angle(int h) const;  // at from(h)
  // Flips and collapses may move these faces, and what they are split into; `released` has a mark per face of the input.
  void release(std::vector<char> released) { released_ = std::move(released); }
  bool is_released(int f) const { return released_[f]; }
  // How far the surface would move if the edge were flipped; 0 at a boundary.
  double bulge(int h) const;
  // A boundary, or a sharp edge between faces that are not just rounding.
  bool is_curve(int h) const;
  // Could no flip remove it, whatever the shape of the triangles?
  bool is_held(int h) const { return bulge(h) > tolerance_at(h) || is_curve(h); }

  // Flips the edge if that makes the smaller of the smallest angles larger.
  bool flip(int h);
  // Moves from(h) onto to(h) if the smallest angle around hardly gets smaller, or stays above `enough`.
  bool collapse(int h, double enough);
  // Splits the edge about where `fraction` of it is, at a point that the curve once went through if there is one. Gives the new vertex.
  int split(int h, double fraction);

  // The mesh as a surface of its own; the place of each of its points goes into `place`, source_face names a face of the input
  // that is closest to the centroid.
  TriangleSurface packed(std::vector<SurfacePoint>& place) const;
  // Of the input, if it was needed.
  const std::shared_ptr<const SurfaceDistanceQuery>& query_of_input() const { return query_; }

 private:
  struct Star;
  std::optional<SurfacePoint> place_on_edge(int h, double fraction) const;
  bool gather(int h, Star& star) const;
  bool stays_on_curve(int h, Star& star) const;
  double deviation_of_star(const Star& star, int u) const;
  double distance_to_input(const Vec3& p, int guess) const;
  Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) const;
  Vec3 area_vector(int f) const {
    return area_vector(points_[mesh_.origin[3 * f]], points_[mesh_.origin[3 * f + 1]], points_[mesh_.origin[3 * f + 2]]);
  }
  // Made when it is first asked for: where nothing is done, which is usual for scans, it would take most of the time.
  const SurfaceDistanceQuery& query() const {
    if (!query_) query_ = std::make_shared<const SurfaceDistanceQuery>(input_);
    return *query_;
  }
  // What a flip of the edge may move.
  double tolerance_at(int h) const {
    return released_[h / 3] && (mesh_.opposite[h] < 0 || released_[mesh_.opposite[h] / 3]) ? options_.tolerance : 0;
  }

  GuardOptions options_;
  double sharp_cosine_;
  const TriangleSurface& input_;
  mutable std::shared_ptr<const SurfaceDistanceQuery> query_;  // see query()
  EditMesh mesh_;
  std::vector<Vec3> points_;
  std::vector<SurfacePoint> place_;
  std::vector<char> released_;             // per face
  std::vector<double> moved_;              // per face: a bound of its distance to the input
  std::vector<int> inside_;                // per face: face of the input that it lies in, -1: not in one
  std::vector<std::vector<Vec3>> passed_;  // per edge name: points of the curve that were taken out of it
};

}  // namespace hybrid_mesh
