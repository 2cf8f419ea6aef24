// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/context.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

struct ClosestPoint {
  int face = -1;
  std::array<double, 3> weights{0, 0, 0};  // barycentric, of the face's corners in their order; none negative, their sum is 1
  double squared_distance = 0;
};

// Closest points on a set of triangles. Holds a copy of what it needs; queries from several threads at once are safe. Of several
// faces at exactly the same distance the first is given, so that a result depends on nothing but the triangles and the point.
class SurfaceDistanceQuery {
 public:
  // Throws Error{InvalidInput} if there is no face.
  explicit SurfaceDistanceQuery(const TriangleSurface& surface);
  SurfaceDistanceQuery(const TriangleSurface& surface, const Progress& progress);
  SurfaceDistanceQuery(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces);
  ~SurfaceDistanceQuery();
  SurfaceDistanceQuery(SurfaceDistanceQuery&&) noexcept;
  SurfaceDistanceQuery& operator=(SurfaceDistanceQuery&&) noexcept;

  ClosestPoint closest(const Vec3& p) const;
  // The same result, found faster if the face `guess` is near p (-1: no guess).
  ClosestPoint closest(const Vec3& p, int guess) const;
  // Squared distance of p to one face.
  double squared_distance(const Vec3& p, int face) const;
  // Puts the faces whose boxes meet the box [low, high] into `faces`, in an order that depends on the triangles alone. False, with some
  // of them, if there are more than `most`.
  bool faces_in_box(const Vec3& low, const Vec3& high, std::size_t most, std::vector<int>& faces) const;

 private:
  class Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace hybrid_mesh
