// SPDX-License-Identifier: GPL-3.0-or-later
// Private to hierarchy/.
#pragma once

#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Leaves up to a level as polygons: hanging nodes are corners.
struct HybridMesh::Polygons {
  struct Face {
    int node, owner;
    Square square;  // in the owner's
  };
  struct Corner {
    VertexId vertex;
    HalfEdge half;  // to the next corner
    double u, v;    // in the owner's square
  };
  std::vector<Face> faces;
  std::vector<int> offsets{0};
  std::vector<Corner> corners;
  int highest = 0;  // level of a face

  bool conforming() const { return corners.size() == 4 * faces.size(); }
};

}  // namespace hybrid_mesh
