// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {

// A point in a face.
struct FacePoint {
  int face = -1;
  Vec3 at = Vec3::Zero();
};

// The point of a segment nearest to p, as the fraction of the way from a to b.
double nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);
// The point of a triangle nearest to p, as weights of its corners, none negative. Returns the squared distance.
double nearest_in_triangle(const Vec3& p, const std::array<Vec3, 3>& corners, std::array<double, 3>& weights);

// Finds points and ways on a mesh, which may grow between calls.
class SurfacePaths {
 public:
  SurfacePaths(const EditMesh& mesh, const std::vector<Vec3>& points) : mesh_(mesh), points_(points) {}

  std::array<Vec3, 3> corners(int face) const {
    return {points_[mesh_.from(3 * face)], points_[mesh_.from(3 * face + 1)], points_[mesh_.from(3 * face + 2)]};
  }
  // The point nearest to p on the faces around `guess`, which is not far from it.
  FacePoint locate(const Vec3& p, int guess);
  // A short way between two points: the edges that it crosses, and where. Nothing if there is none of at most length `most`.
  std::optional<std::vector<SurfaceCurves::Step>> join(const FacePoint& from, const FacePoint& to, double most);

 private:
  const EditMesh& mesh_;
  const std::vector<Vec3>& points_;
  std::vector<int> stamp_, previous_;  // per half-edge or face
  std::vector<double> cost_;
  int now_ = 0;
};

}  // namespace hybrid_mesh
