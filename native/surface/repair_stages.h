// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "surface/repair.h"

namespace hybrid_mesh {

// What the stages of repair() work on. Half-edges are numbered as in TriangleSurface; `mate` is the half-edge that one is glued to, -1 at a
// boundary. Before orient(), mates may run in the same direction.
struct RepairMesh {
  std::vector<Vec3> points;               // by origin, scaled into [-1, 1]
  std::vector<std::array<int, 3>> faces;  // of vertices
  std::vector<int> source;                // the triangle of the soup that holds each face
  std::vector<int> mate;
  std::vector<int> origin;  // of each vertex: the point it is a copy of

  int half_edge_count() const { return static_cast<int>(mate.size()); }
  int from(int h) const { return faces[h / 3][h % 3]; }
  int to(int h) const { return faces[h / 3][(h + 1) % 3]; }
  int apex(int h) const { return faces[h / 3][(h + 2) % 3]; }
  const Vec3& position(int vertex) const { return points[origin[vertex]]; }
  bool same_direction(int h, int g) const { return from(h) == from(g); }
  void glue(int h, int g) { mate[h] = g, mate[g] = h; }
  void cut(int h) {
    if (mate[h] >= 0) mate[mate[h]] = -1;
    mate[h] = -1;
  }
  // Removes the faces that are not kept; their neighbours get boundaries.
  void keep_faces(const std::vector<char>& keep);
  // The number of the component of each face, in order of their first faces; faces are connected by mates.
  std::vector<int> components(int& count) const;
};

// Leaves one of the faces with the same corners, of the orientation that most of them have. If they balance, both sides of a sheet without
// volume are there: a wall that bounds surface all around (two solids glued together) goes altogether, and so does a single pair of faces that
// sticks out of a surface, since one of the two alone would leave boundaries where there were none. A sheet of such pairs with a free border,
// as a leaf modelled from both sides, stays as one layer.
void remove_duplicate_faces(RepairMesh& mesh, RepairReport& report);

// Glues every edge of two faces, and at edges of more as many pairs as can be: pairs that close a fan, then those of one sheet, then of
// matching orientation, then the flattest. Never makes a two-sided sheet one-sided. Counts non-manifold edges and vertices.
void pair_half_edges(RepairMesh& mesh, RepairReport& report);

// Turns as few faces as possible, by whole components; cuts one-sided components open.
void orient(RepairMesh& mesh, RepairReport& report);

// Gives every fan of faces around a point a vertex of its own. Precondition: oriented. After it no two edges share both ends.
void separate_fans(RepairMesh& mesh);

// Takes faces without area out of the surface where this opens no crack. Precondition: separate_fans(), which must be called again after it.
void remove_degenerate_faces(RepairMesh& mesh, RepairReport& report);

}  // namespace hybrid_mesh
