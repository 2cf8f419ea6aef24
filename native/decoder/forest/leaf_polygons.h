// SPDX-License-Identifier: GPL-3.0-or-later
// Private to forest/.
#pragma once

#include <vector>

#include "decoder/forest/quad_forest.h"

namespace hybrid_mesh {

// Leaves up to a level as polygons: hanging nodes are corners.
struct QuadForest::Polygons {
  struct Corner {
    VertexId vertex;
    HalfEdge half;      // to the next corner
    int side;           // of the node, on which that is
    double begin, end;  // the part of the side
  };
  std::vector<int> faces;  // nodes
  std::vector<int> offsets{0};
  std::vector<Corner> corners;

  bool conforming() const { return corners.size() == 4 * faces.size(); }
};

}  // namespace hybrid_mesh
