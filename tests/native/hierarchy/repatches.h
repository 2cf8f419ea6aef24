// SPDX-License-Identifier: GPL-3.0-or-later
// Simple irregular operations for tests.
#pragma once

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// One quad becomes the five faces of a cube.
inline Repatch cube_on(const HybridMesh& mesh, int node) {
  Repatch repatch;
  repatch.kind = "add_cubes";
  repatch.level = mesh.level(node);
  repatch.removed = {node};
  repatch.new_vertices = 4;
  for (int s = 0; s < 4; ++s) repatch.boundary.push_back(mesh.corner(node, s));
  for (int s = 0; s < 4; ++s) repatch.quads.push_back({s, (s + 1) % 4, -1 - (s + 1) % 4, -1 - s});
  repatch.quads.push_back({-1, -2, -3, -4});
  return repatch;
}

inline Repatch opening(const HybridMesh& mesh, const std::vector<int>& nodes) {
  Repatch repatch;
  repatch.kind = "open_boundary";
  repatch.level = mesh.level(nodes[0]);
  repatch.removed = nodes;
  return repatch;
}

// Four quads in place of two: a tube between them, turned by `turn` corners.
inline Repatch tube_between(const HybridMesh& mesh, int a, int b, int turn) {
  Repatch repatch;
  repatch.kind = "connect";
  repatch.level = mesh.level(a);
  repatch.removed = {a, b};
  for (int s = 0; s < 4; ++s) repatch.boundary.push_back(mesh.corner(a, s));
  for (int s = 0; s < 4; ++s) repatch.boundary.push_back(mesh.corner(b, s));
  for (int s = 0; s < 4; ++s) {
    const int t = (turn + 8 - s) % 4;
    repatch.quads.push_back({s, (s + 1) % 4, 4 + t, 4 + (t + 1) % 4});
  }
  return repatch;
}

}  // namespace hybrid_mesh
