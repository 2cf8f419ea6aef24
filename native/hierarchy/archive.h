// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Everything that a hierarchy is made from, without what follows from it. Nodes, half-edges and vertices have the numbers of the canonical
// order: base quads; then level by level the children of the refined nodes, in order, and the root quads of that level's operations.
struct HierarchyParts {
  int base_vertices = 0;
  std::vector<std::array<int, 4>> base_quads;
  std::vector<std::array<SideLink, 4>> base_links;
  std::vector<std::uint8_t> sharp;    // per base quad, a bit a side: it is on a feature. Empty: none is
  std::vector<std::uint8_t> refined;  // per node: 1 if it has children
  std::vector<Repatch> operations;    // by level, `sides` complete
  std::vector<bool> enabled;          // per operation
  FaceClosure closure = FaceClosure::Quads;
  std::vector<std::vector<std::pair<VertexId, Vec3>>> level_positions;  // sorted by vertex
  std::vector<std::pair<VertexId, Vec3>> final_positions;
  std::vector<std::pair<int, PatchMap>> maps;  // by node
};

HierarchyParts take_apart(const HybridMesh& mesh);

// Throws Error{InvalidInput} if the parts make no valid hierarchy. Time and memory grow with the size of the parts.
HybridMesh put_together(HierarchyParts parts);

}  // namespace hybrid_mesh
