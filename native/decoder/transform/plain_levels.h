// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "decoder/forest/level_mesh.h"
#include "decoder/transform/level_quads.h"

namespace hybrid_mesh {

// The levels of a hierarchy in which every quad is refined and nothing else is done, made one from the other without the forest: numbers, names and
// orders are those that a forest has which grows from the same base.
class PlainLevels {
 public:
  // Level 0 of a base: `mesh` is its connectivity.
  PlainLevels(const QuadForest& base, LevelMesh mesh);

  const LevelMesh& mesh() const { return mesh_; }
  // Goes on with the next level and hands out what was of the one before: its mesh, its quads, and the vertex of the next one's mesh that each of
  // their rows is (RefinedRows).
  struct Step {
    LevelMesh mesh;
    LevelQuads quads;
    std::vector<int> rows;
  };
  // `last`: there are none after it.
  Step refine(bool last);

 private:
  void number_edges(LevelQuads& fine);
  std::vector<int> number_vertices(LevelMesh& fine) const;
  void number_corners(const LevelMesh& fine_mesh, LevelQuads& fine) const;

  LevelMesh mesh_;
  LevelQuads quads_;
  int nodes_ = 0, edges_ = 0;  // of the forest so far
};

}  // namespace hybrid_mesh
