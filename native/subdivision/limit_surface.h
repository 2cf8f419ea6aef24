// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "subdivision/catmull_clark.h"

namespace hybrid_mesh {

// Where the vertices of a mesh lie on the limit surface, if it is subdivided without operations from there on.
struct LimitSurface {
  std::vector<Vec3> points;   // #V
  std::vector<Vec3> normals;  // #V, of length 1. The mean of both sides' normals on a crease, of the quads' corners at a sharp vertex; 0 if all of them vanish
};

// The mesh must be made of whole nodes of one level, as SubdividedMesh::mesh is. Throws Error{InvalidInput} if it is not, or for rules as subdivide() does;
// Error{Unsupported} if it has an interior vertex of valence 1, where the limit does not exist.
LimitSurface limit_surface(const HybridMesh& hierarchy, const QuadMesh& mesh, const CatmullClarkRules& rules);

}  // namespace hybrid_mesh
