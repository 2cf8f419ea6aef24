// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/quad_topology.h"

namespace hybrid_mesh {

int QuadTopology::add_edge(int from, int to) {
  ends.push_back({from, to});
  sides.push_back({-1, -1});
  edge_sharpness.push_back(0);
  return 2 * edge_count() - 2;
}

void QuadTopology::add_face(const std::array<int, 4>& half_edges) {
  const int face = face_count();
  std::array<int, 4> vertices;
  for (int i = 0; i < 4; ++i) {
    const int h = half_edges[i];
    vertices[i] = ends[h >> 1][h & 1];
    sides[h >> 1][h & 1] = 4 * face + i;
  }
  corners.push_back(vertices);
  half.push_back(half_edges);
}

VertexFans::VertexFans(const QuadTopology& topology)
    : topology_(&topology), first_(topology.vertex_count + 1, 0), corners_(4 * topology.corners.size()), last_(topology.vertex_count, -1) {
  const int corner_count = 4 * topology.face_count();
  std::vector<int> start(topology.vertex_count, -1);
  for (int c = 0; c < corner_count; ++c) {
    const int v = topology.corners[c / 4][c % 4];
    ++first_[v + 1];
    // A fan that is open starts at the boundary.
    if (start[v] < 0 || topology.side_of(topology.half_at(c) ^ 1) < 0) start[v] = c;
  }
  for (int v = 0; v < topology.vertex_count; ++v) {
    first_[v + 1] += first_[v];
    int c = start[v];
    for (int i = first_[v]; i < first_[v + 1]; ++i) {
      corners_[i] = c;
      const int spoke = topology.half_at(c / 4 * 4 + (c + 3) % 4) ^ 1;
      c = topology.side_of(spoke);
      if (c >= 0) continue;
      last_[v] = spoke;
      break;
    }
  }
}

}  // namespace hybrid_mesh
