// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"
#include "remesh/crossing_faces.h"
#include "surface/closest_point.h"
#include "surface/placement.h"

namespace hybrid_mesh {

// Where a mesh runs through itself: pairs of its faces that meet elsewhere than at the vertices that they share.
struct MeshIntersections {
  std::int64_t pairs = 0;           // where the surface that it was made of does not
  std::int64_t pairs_of_input = 0;  // where it does as well
  std::optional<Vec3> where;        // of the first of `pairs`
};

// Where a surface runs through itself. It is looked at only near pairs of faces of a mesh that do.
class SurfaceCrossings {
 public:
  SurfaceCrossings(const PlacedSurface& surface, const Progress& progress);

  // Of each pair, in order: does the surface run through itself there as well, inside the box around the two faces?
  std::vector<char> at(const QuadMesh& mesh, const CrossingFaces& pairs, const Progress& progress) const;

 private:
  PlacedSurface surface_;
  SurfaceDistanceQuery query_;
};

// `surface`: that the mesh was made of, placed where the mesh is.
MeshIntersections mesh_intersections(const QuadMesh& mesh, const PlacedSurface& surface, const Progress& progress);

}  // namespace hybrid_mesh
