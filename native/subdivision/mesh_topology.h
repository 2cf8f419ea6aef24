// SPDX-License-Identifier: GPL-3.0-or-later
// Private to subdivision/.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "decoder/forest/vertex_index.h"
#include "subdivision/quad_topology.h"

namespace hybrid_mesh {

// A mesh of whole nodes: face f is node mesh.node[f], and corners and sides are the node's.
struct MeshTopology {
  QuadTopology quads;
  std::vector<int> edges;  // #E: the hierarchy's edges

  // Throws Error{InvalidInput} if the mesh is of another kind.
  MeshTopology(const HybridMesh& hierarchy, const QuadMesh& mesh);
};

// Sharpness of the edges and vertices of a level, by the hierarchy's edges and vertices; sorted, each once.
struct Sharpness {
  std::vector<std::pair<int, float>> edges;
  std::vector<std::pair<VertexId, float>> vertices;
};

// Gives a topology the sharpness that rules speak of. Throws Error{InvalidInput} if there is no such edge or vertex, or no such sharpness.
void apply_rules(const CatmullClarkRules& rules, const QuadMesh& mesh, MeshTopology& topology);
// Sharpness left one level below, of the edges' parts and of the vertices. The nodes of the mesh must be refined.
Sharpness refined_sharpness(const HybridMesh& hierarchy, const QuadMesh& mesh, const MeshTopology& topology);
// Gives a topology the sharpness of those edges and vertices that it has.
void apply_sharpness(const Sharpness& sharpness, const QuadMesh& mesh, MeshTopology& topology);
// The rules under which a topology has the sharpness that it has.
CatmullClarkRules rules_of(const QuadMesh& mesh, const MeshTopology& topology);

}  // namespace hybrid_mesh
