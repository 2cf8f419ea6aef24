// SPDX-License-Identifier: GPL-3.0-or-later
// Private to wavelets/.
#pragma once

#include <array>
#include <vector>

#include "subdivision/step_matrix.h"

namespace hybrid_mesh {

// What subdivision alone says of the vertices of M^j or N^j, from the positions of N^{j-1}. An operation's vertices it says nothing of.
struct LevelPrediction {
  struct Mean {
    int vertex = -1;
    std::vector<int> of;
  };
  StepMatrix step;
  std::vector<int> vertex_at;             // #rows of the step: vertex of the mesh, -1 if it has it not
  std::vector<std::array<int, 2>> stays;  // vertex of N^{j-1} and of the mesh: not refined
  std::vector<Mean> closing;              // of the mesh: made by the closure of leaves, put in the mean of what they close
  std::vector<int> inserted;              // the mesh's other vertices

  LevelPrediction(const HybridMesh& hierarchy, const QuadMesh& coarse, const QuadMesh& mesh, int level, BoundaryRule boundary);

  // Of all vertices but the inserted ones, which are in the origin, and the closing ones, which close() puts in their places.
  std::vector<Vec3> regular(const std::vector<Vec3>& coarse) const;
  void close(std::vector<Vec3>& points) const;

 private:
  std::size_t count_;
};

Vec3 mean_of(const std::vector<Vec3>& points, const std::vector<int>& vertices);
// The vertices of a mesh in whose mean subdivision puts one that the closure of leaves makes: the ends of its edge or the corners of its leaf.
class VertexIndex;
std::vector<int> vertices_closed(const HybridMesh& hierarchy, const VertexIndex& find, VertexId closing);

}  // namespace hybrid_mesh
