// SPDX-License-Identifier: GPL-3.0-or-later
// Private to subdivision/: the Catmull-Clark masks of OpenSubdiv applied to points.
#pragma once

#include <vector>

#include "subdivision/quad_topology.h"

namespace hybrid_mesh {

// From here on a sharp feature stays sharp.
inline constexpr float infinite_sharpness = 10;
// Sharpness one level finer.
float refined_sharpness(float sharpness);

// Positions one level finer, by what the vertices come from.
struct RefinedPoints {
  std::vector<Vec3> vertices, edges, faces;
};
RefinedPoints refine_points(const QuadTopology& topology, const VertexFans& fans, const std::vector<Vec3>& points);

// Positions on the limit surface and two tangents, the second counter-clockwise of the first. Exact for vertices without semi-sharp features that are
// interior and smooth with a valence of 3 or more, have two sharp edges, or stay where they are; the tangents of two sharp edges are those of the
// span of faces between the first and the second.
struct LimitPoints {
  std::vector<Vec3> points, tangents, cross_tangents;
};
LimitPoints limit_points(const QuadTopology& topology, const VertexFans& fans, const std::vector<Vec3>& points);

}  // namespace hybrid_mesh
