// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "subdivision/catmull_clark.h"

namespace hybrid_mesh {

// Where the vertices of a mesh lie on the limit surface, if it is subdivided without operations from there on.
struct LimitSurface {
  std::vector<Vec3> points;  // #V
  // #V, of length 1. On a crease the mean of the normals of both sides, at a sharp vertex that of its quads' corners; 0 if nothing gives a direction.
  std::vector<Vec3> normals;
};

// The mesh must be made of whole nodes of one level, as SubdividedMesh::mesh is. Throws Error{InvalidInput} if it is not, or for rules as subdivide()
// does; Error{Unsupported} if it has an interior vertex of valence 1, where the limit does not exist.
LimitSurface limit_surface(const HybridMesh& hierarchy, const QuadMesh& mesh, const CatmullClarkRules& rules);

}  // namespace hybrid_mesh
