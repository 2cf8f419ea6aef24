// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

namespace hybrid_mesh {

// A patch and one of its four sides; patch -1: none.
struct PatchSide {
  int patch = -1;
  int side = 0;
};

// The quads of one level, which are the patches of its layout: their nodes and what lies across their sides, and nothing of where they are.
struct QuadGraph {
  std::vector<std::array<int, 4>> nodes;             // per patch: counter-clockwise
  std::vector<std::array<PatchSide, 4>> neighbours;  // per patch and side; side i runs from node i to node i + 1
  int node_count = 0;

  int patch_count() const { return static_cast<int>(nodes.size()); }
};

// The quadrants of all patches: patch q becomes 4 q .. 4 q + 3, the quadrants (0, 0), (1, 0), (1, 1), (0, 1) of its square. Nodes keep their numbers,
// new ones follow.
QuadGraph quadrisected(const QuadGraph& graph);

// Patches around each node.
std::vector<int> node_valences(const QuadGraph& graph);
// Whether each node is on the boundary.
std::vector<char> boundary_nodes(const QuadGraph& graph);

}  // namespace hybrid_mesh
