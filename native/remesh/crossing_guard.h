// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "hierarchy/hybrid_mesh.h"
#include "surface/closest_point.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {

// Counts, while a mesh's vertices are moved one by one, which of its faces run through others. Keeps a reference to the mesh.
class CrossingGuard {
 public:
  explicit CrossingGuard(const QuadMesh& mesh);

  // The pairs of faces, one of them at the vertex, that meet elsewhere than at the vertices that they share, if the vertex is at a place.
  int crossings(int v, const Vec3& place) const;
  // May the vertex go there: are there no more such pairs than now?
  bool allows(int v, const Vec3& place) const;
  // To be called for every vertex that has been moved.
  void moved(int v);

  const std::vector<int>& faces_at(int v) const { return faces_at_[v]; }

 private:
  struct MovedFace {
    int face;
    Eigen::AlignedBox3d box;
  };

  Eigen::AlignedBox3d box_of(int face) const;
  std::vector<int> faces_in_box(const Eigen::AlignedBox3d& box) const;

  const QuadMesh& mesh_;
  std::vector<std::vector<int>> faces_at_;  // per vertex
  const Triangulation start_;               // of the mesh as it was at the start
  const SurfaceDistanceQuery at_start_;     // on these triangles
  std::vector<int> moved_at_;               // per face: its place among the moved ones, -1: it is where it was
  std::vector<MovedFace> moved_faces_;
};

}  // namespace hybrid_mesh
