// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// The connectivity of a triangle mesh under half-edge collapses and edge flips that can be undone, last first.
//
// Half-edge h = 3 f + i starts at origin[h]; opposite[h] is -1 at the boundary; edge[h] names the undirected edge. A collapse
// leaves the two dead faces' entries as they were, so that the undo reads what it must restore from them: the log holds one
// half-edge an operation. Invariants: out[v] leaves v, and for a boundary vertex it is the clockwise-most one (its opposite is -1);
// the mesh stays simplicial and manifold (collapse and flip are refused where they would break this).
class EditMesh {
 public:
  EditMesh() = default;
  explicit EditMesh(const TriangleSurface& surface);

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int prev(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int from(int h) const { return origin[h]; }
  int to(int h) const { return origin[next(h)]; }
  int apex(int h) const { return origin[prev(h)]; }
  // The next half-edge that leaves the same vertex, -1 past a boundary.
  int ccw(int h) const { return opposite[prev(h)]; }
  int cw(int h) const { return opposite[h] < 0 ? -1 : next(opposite[h]); }
  bool is_boundary(int v) const { return opposite[out[v]] < 0; }
  bool face_alive(int f) const { return alive[f]; }
  bool vertex_alive(int v) const { return vertex_live[v]; }
  int valence(int v) const;  // number of edges
  // The vertices around v, counter-clockwise; for a boundary vertex from its clockwise-most to its last neighbour.
  void ring(int v, std::vector<int>& vertices) const;
  template <class Visit>
  void for_ring(int v, const Visit& visit) const {
    int h = out[v];
    do {
      visit(to(h));
      const int g = ccw(h);
      if (g < 0) {
        visit(apex(h));
        return;
      }
      h = g;
    } while (h != out[v]);
  }
  void grow(std::vector<int>& vertices, int rings) const;  // adds rings of neighbours
  std::vector<int> boundary_loops() const;                 // per vertex the number of its boundary loop, or -1. Operations leave it as it is
  int find(int a, int b) const;                            // the half-edge a -> b or -1 (the mesh may still hold b -> a at a boundary)
  bool adjacent(int a, int b) const { return find(a, b) >= 0 || find(b, a) >= 0; }

  // Would moving from(h) onto to(h) keep a simplicial manifold of the same topology, boundaries included?
  bool can_collapse(int h) const;
  void collapse(int h);
  void undo_collapse(int h);  // only as the inverse of the last operation not yet undone
  bool can_flip(int h) const;
  void flip(int h);
  void undo_flip(int h);
  // Puts a new vertex, whose number is given back, on the edge of h; its faces are split in two. The half-edge h now ends there. Not undone.
  int split(int h);

  std::vector<int> origin, opposite, edge;               // per half-edge
  std::vector<int> out;                                  // per vertex
  std::vector<char> alive;                               // per face
  std::vector<char> vertex_live;                         // per vertex
  int face_count = 0, vertex_count = 0, edge_count = 0;  // faces and vertices alive; edge names given out

 private:
  void fix_out(int v, int h);
};

}  // namespace hybrid_mesh
