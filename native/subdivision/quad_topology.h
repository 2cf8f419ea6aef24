// SPDX-License-Identifier: GPL-3.0-or-later
// Private to subdivision/.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "hierarchy/hybrid_mesh.h"
#include "subdivision/catmull_clark.h"

namespace hybrid_mesh {

// A manifold of quads whose edges are told apart by more than their ends: two quads may share several edges, and an edge may join a vertex to itself.
struct QuadTopology {
  int vertex_count = 0;
  std::vector<std::array<int, 4>> corners;  // #F, counter-clockwise
  std::vector<std::array<int, 4>> half;     // #F: half-edge of side i, from corner i to corner i + 1: 2 * edge + (1 if backwards)
  std::vector<std::array<int, 2>> ends;     // #E
  std::vector<std::array<int, 2>> sides;    // #E: 4 * face + side to the left of the edge and of its twin, -1 at a boundary
  std::vector<float> edge_sharpness;        // #E
  std::vector<float> vertex_sharpness;      // #V
  BoundaryRule boundary = BoundaryRule::EdgesOnly;

  int face_count() const { return static_cast<int>(corners.size()); }
  int edge_count() const { return static_cast<int>(ends.size()); }
  int half_at(int corner) const { return half[corner / 4][corner % 4]; }  // corner: 4 * face + corner
  int side_of(int h) const { return sides[h >> 1][h & 1]; }
  int to(int h) const { return ends[h >> 1][(h & 1) ^ 1]; }
  bool is_boundary(int edge) const { return sides[edge][0] < 0 || sides[edge][1] < 0; }

  // Adds an edge and returns its first half-edge.
  int add_edge(int from, int to);
  // Adds a face by its half-edges in order.
  void add_face(const std::array<int, 4>& half_edges);
};

// Faces and edges around every vertex, counter-clockwise.
class VertexFans {
 public:
  explicit VertexFans(const QuadTopology& topology);

  int face_count(int vertex) const { return first_[vertex + 1] - first_[vertex]; }
  int spoke_count(int vertex) const { return face_count(vertex) + is_open(vertex); }
  // At a boundary there is one spoke more than faces.
  bool is_open(int vertex) const { return last_[vertex] >= 0; }
  // Corner of face i, as 4 * face + corner. The face lies between spokes i and i + 1.
  int corner(int vertex, int i) const { return corners_[first_[vertex] + i]; }
  // Spoke i, as the half-edge that leaves the vertex.
  int spoke(int vertex, int i) const { return i < face_count(vertex) ? topology_->half_at(corner(vertex, i)) : last_[vertex]; }

 private:
  const QuadTopology* topology_;
  std::vector<int> first_, corners_;
  std::vector<int> last_;  // the last spoke at a boundary, else -1
};

}  // namespace hybrid_mesh
