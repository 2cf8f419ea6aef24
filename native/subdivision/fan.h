// SPDX-License-Identifier: GPL-3.0-or-later
// Private to subdivision/.
#pragma once

#include <vector>

#include "subdivision/quad_topology.h"

namespace hybrid_mesh {

// A vertex with the quads around it, taken out of a mesh and unfolded. Where the vertex goes under subdivision depends on nothing else.
struct Fan {
  int face_count = 0;
  bool open = false;  // at a boundary
  float vertex_sharpness = 0;
  std::vector<float> edge_sharpness;  // #spokes, counter-clockwise; face i lies between spokes i and i + 1
  Vec3 centre = Vec3::Zero();
  std::vector<Vec3> ends;       // #spokes
  std::vector<Vec3> opposites;  // #faces: corners opposite to the vertex

  int spoke_count() const { return face_count + open; }
  int next(int spoke) const { return spoke + 1 == spoke_count() ? 0 : spoke + 1; }
};

Fan fan_of(const QuadTopology& topology, const VertexFans& fans, int vertex, const std::vector<Vec3>& points);
// The faces from spoke `begin` on, as a fan that ends at a boundary on both sides.
Fan part_of(const Fan& fan, int begin, int face_count);
// The same fan one level finer, by the rules of subdivision.
void refine(std::vector<Fan*>& fans, BoundaryRule boundary);

// Where the vertex ends up, and two tangents, the second counter-clockwise of the first.
struct VertexLimit {
  Vec3 point, tangent, cross_tangent;
};
// By OpenSubdiv's masks; see limit_points() for what these are good for.
std::vector<VertexLimit> limits_of(const std::vector<Fan>& fans, BoundaryRule boundary);
// For what these are not good for: an inner vertex with one infinitely sharp edge, spoke 0, or without any and with two faces.
VertexLimit limit_by_matrix(const Fan& fan);

}  // namespace hybrid_mesh
