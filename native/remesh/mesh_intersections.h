// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"
#include "surface/placement.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Where a mesh runs through itself: pairs of its faces that meet elsewhere than at the vertices that they share.
struct MeshIntersections {
  std::int64_t pairs = 0;           // where the surface that it was made of does not
  std::int64_t pairs_of_input = 0;  // where it does as well
  std::optional<Vec3> where;        // of the first of `pairs`
};

// Faces are split into triangles by triangulate(). The surface is looked at only where the mesh runs through itself: it does so there as well if it
// does inside the box around the two faces. `placement` brings it to where the mesh is.
MeshIntersections mesh_intersections(const QuadMesh& mesh, const TriangleSurface& surface, const Placement& placement, const Progress& progress);

}  // namespace hybrid_mesh
