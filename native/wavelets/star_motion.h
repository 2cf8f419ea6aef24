// SPDX-License-Identifier: GPL-3.0-or-later
// Private to wavelets/.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// How a surface turns and grows at a vertex.
struct Motion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double scale = 1;

  Vec3 operator()(const Vec3& vector) const { return scale * (rotation * vector); }
};

// The identity if more than one is equally near.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

// The vertices of a mesh with their neighbours along edges. What becomes of a vertex's star says how its local frame moves, which consists of its
// normal and two tangents: the normal goes to the new normal; around it, and in length, the star is fitted to the new one by least squares. No
// tangent is chosen, so that nothing depends on the order of quads.
class VertexStars {
 public:
  explicit VertexStars(const QuadMesh& mesh);

  // Whether a flag is set of a vertex or of a neighbour.
  bool any(const std::vector<char>& flags, int vertex) const;
  // Where the normals of a star cancel each other out, its edges alone say how it turns; where these are on one line, it does not turn.
  Motion motion(int vertex, const std::vector<Vec3>& before, const std::vector<Vec3>& after) const;

 private:
  struct Shape;
  std::vector<int> first_;                      // #V + 1
  std::vector<std::array<int, 2>> neighbours_;  // at every corner of a face: the next and the previous one
};

}  // namespace hybrid_mesh
