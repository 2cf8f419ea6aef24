// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "layout/drawn/layout_transfer.h"

namespace hybrid_mesh {

// The components of a mesh: which of them holds each point; of each its Euler number and its number of boundary loops.
struct MeshComponents {
  std::vector<int> of;
  std::vector<std::array<int, 2>> topology;
};
MeshComponents components_of(const TriangleSurface& surface);

// The quads of an outline as a surface: the edges that two of them share, and their ends around each node. Keeps a reference to the outline.
class QuadComplex {
 public:
  // From node to node as the side of the quad on its left runs.
  struct Edge {
    int from = -1, to = -1;
    PatchSide left, right;
  };
  struct EdgeEnd {
    int edge = -1;
    bool at_start = true;
    friend bool operator==(const EdgeEnd&, const EdgeEnd&) = default;
  };

  // Throws Error{InvalidInput} if the quads are no oriented surface, or an index or a coordinate cannot be used.
  explicit QuadComplex(const LayoutOutline& outline);

  int quads() const { return static_cast<int>(outline_.quads.size()); }
  int nodes() const { return static_cast<int>(outline_.nodes.size()); }
  int node(int q, int i) const { return outline_.quads[q][i % 4]; }
  int edges() const { return static_cast<int>(edges_.size()); }
  const Edge& edge(int e) const { return edges_[e]; }
  int edge_at(int q, int i) const { return edge_at_[q][i]; }  // of a side, -1: the boundary
  bool is_left(int q, int i) const { return edges_[edge_at_[q][i]].left.patch == q && edges_[edge_at_[q][i]].left.side == i; }
  const std::vector<EdgeEnd>& around(int node) const { return around_[node]; }  // counter-clockwise; on the boundary from the clockwise-most on
  int next_on_boundary(int node) const { return next_on_boundary_[node]; }      // the node that the boundary leads to, -1 inside
  MeshComponents components() const;

 private:
  void check_numbers() const;
  void find_neighbours();
  void check_neighbours() const;
  void order_nodes();

  const LayoutOutline& outline_;
  std::vector<std::array<PatchSide, 4>> neighbours_;
  std::vector<std::array<int, 4>> edge_at_;
  std::vector<Edge> edges_;
  std::vector<std::vector<EdgeEnd>> around_;
  std::vector<int> next_on_boundary_;
};

}  // namespace hybrid_mesh
