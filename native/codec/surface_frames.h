// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
#pragma once

#include <array>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Normal and two tangents of a vertex, orthonormal.
using Frame = std::array<Vec3, 3>;

inline const Frame coordinate_axes = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};

// Of a mesh's vertices, at other points than its own. Additions, products, quotients and roots in an order that the mesh gives: wherever doubles are
// those of IEEE 754 and no two operations are made one, the same bits.
class SurfaceFrames {
 public:
  SurfaceFrames(const QuadMesh& mesh, const std::vector<Vec3>& points);
  Frame operator()(int vertex) const;

 private:
  struct Directions {
    Vec3 normal = Vec3::Zero(), tangent = Vec3::Zero();
    bool met = false;
  };
  std::vector<Directions> directions_;
};

}  // namespace hybrid_mesh
