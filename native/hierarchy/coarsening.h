// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// A hierarchy made anew, and where its parts are found again.
struct Coarsened {
  HybridMesh mesh;
  std::vector<int> node;                              // per node of the old one; -1: it is not refined so far any more
  std::vector<std::pair<VertexId, VertexId>> vertex;  // old and new names of the corners of nodes that operations take or that have maps, sorted
};

// The same hierarchy, refined no farther than its operations and the quads with maps of their own need it. Not balanced. It has no positions.
Coarsened coarsened(const HybridMesh& mesh);

}  // namespace hybrid_mesh
