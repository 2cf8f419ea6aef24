// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "decoder/forest/quad_forest.h"

namespace hybrid_mesh {

// The quads of one level among the faces of a mesh: flat lists of what is around each. Corners and sides of quads have one number, 4 * quad + i;
// side i starts at corner i. Edges are told apart by more than their ends: two quads may share several.
struct LevelQuads {
  std::vector<int> node;                 // #F
  std::vector<int> vertex;               // #F * 4, of corners
  std::vector<int> half;                 // #F * 4, of sides: 2 * edge + (1 if backwards)
  std::vector<int> across;               // #F * 4: the side glued to each, -1 at a boundary
  std::vector<int> edge;                 // #E: the forest's; in the order in which they appear
  std::vector<std::array<int, 2>> side;  // #E: sides to the left of the edge and of its twin, -1
  std::vector<char> sharp;               // #E
  std::vector<int> in_mesh;              // #V: vertex of the mesh; in the order in which edges have them
  std::vector<int> start;                // #V: the first corner, counter-clockwise; any if the quads go all around
  std::vector<int> valence;              // #V: quads
  std::vector<int> creases;              // #V: edges that are sharp or at a boundary

  int quad_count() const { return static_cast<int>(node.size()); }
  int edge_count() const { return static_cast<int>(edge.size()); }
  int vertex_count() const { return static_cast<int>(in_mesh.size()); }
  static int next(int side) { return (side & ~3) | ((side + 1) & 3); }
  static int previous(int side) { return (side & ~3) | ((side + 3) & 3); }
  int edge_at(int side) const { return half[side] >> 1; }
  bool is_boundary(int e) const { return side[e][0] < 0 || side[e][1] < 0; }
  // The ends of an edge, forwards.
  int end(int e, int i) const {
    const int s = side[e][0] >= 0 ? side[e][0] : side[e][1], place = side[e][0] >= 0 ? i : 1 - i;
    return vertex[place == 0 ? s : next(s)];
  }
  // The corner after another one around their vertex, counter-clockwise; -1 at a boundary.
  int turned(int corner) const { return across[previous(corner)]; }
};

// `nodes`: of the mesh's faces, those under one node following each other. `vertices`: the mesh's.
LevelQuads level_quads(const QuadForest& forest, const std::vector<int>& nodes, const std::vector<VertexId>& vertices, int level);

// Fills in start, valence and creases from the other lists.
void count_around(LevelQuads& quads);

}  // namespace hybrid_mesh
