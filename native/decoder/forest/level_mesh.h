// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "decoder/forest/names.h"

namespace hybrid_mesh {

// The connectivity of a mesh taken out of a forest. Vertices are numbered as they appear in its faces, faces as they appear in the trees, so that the
// numbering depends on the forest's structure alone.
struct LevelMesh {
  std::vector<std::int64_t> offsets{0};  // #F + 1
  std::vector<std::int32_t> indices;
  std::vector<std::int32_t> node;  // #F: node under the face (several faces have the same after closure)
  std::vector<VertexId> vertex;    // #V
  std::vector<char> sharp;         // as `indices`: is the edge from this corner to the face's next one on a feature? Empty: none is
  bool conforming = true;          // no leaf has hanging nodes: every face is a whole node, its corners and sides those of the node

  std::size_t face_count() const { return offsets.size() - 1; }
  std::size_t vertex_count() const { return vertex.size(); }
};

// Where a vertex lies in the first face that has it: on a side of the face's node, or in its middle.
struct PlaceInFace {
  int node = -1;
  int side = -1;  // -1: in the middle
  double t = 0;   // of the side's length, from its start
};

}  // namespace hybrid_mesh
