// SPDX-License-Identifier: GPL-3.0-or-later
// Private to subdivision/: positions for vertices that do not come out of subdivision.
#pragma once

#include <vector>

#include "subdivision/mesh_topology.h"

namespace hybrid_mesh {

// A level's own mesh N^j, with the hierarchy's own positions: kept for the level or sampled from maps; not a number where there is neither.
QuadMesh own_level_mesh(const HybridMesh& hierarchy, int level);
// The same of the final mesh.
QuadMesh own_final_mesh(const HybridMesh& hierarchy);

// Gives positions to the vertices of `mesh`, a level as own_level_mesh() gives it. `placed` says which of its points are to be kept; `own` has
// the hierarchy's. Throws Error{InvalidInput} if there is no position for a vertex.
void place_vertices(const MeshTopology& topology, OperationVertices where, const std::vector<char>& placed, const std::vector<Vec3>& own,
                    QuadMesh& mesh);

}  // namespace hybrid_mesh
