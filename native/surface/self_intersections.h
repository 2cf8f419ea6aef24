// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/context.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Two triangles of a surface that run through one another.
struct SelfIntersection {
  std::array<int, 2> faces;  // the lower one first
  std::vector<Vec3> common;  // see common_polygon()
};

// All pairs of triangles that meet elsewhere than at the corners and edges that they share, in order. Exact: touching is meeting, but triangles
// without area meet nothing. In parallel; the result does not depend on the number of threads.
std::vector<SelfIntersection> find_self_intersections(const std::vector<Vec3>& points, const std::vector<std::array<int, 3>>& faces,
                                                      const Progress& progress);

}  // namespace hybrid_mesh
