// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/quad_graph.h"

namespace hybrid_mesh {

QuadGraph quadrisected(const QuadGraph& graph) {
  QuadGraph out;
  out.node_count = graph.node_count;
  const int old_count = graph.patch_count();
  std::vector<std::array<int, 4>> middle(old_count);
  for (int q = 0; q < old_count; ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchSide other = graph.neighbours[q][i];
      const bool known = other.patch >= 0 && (other.patch < q || (other.patch == q && other.side < i));
      middle[q][i] = known ? middle[other.patch][other.side] : out.node_count++;
    }
  out.nodes.resize(4 * old_count);
  out.neighbours.resize(4 * old_count);
  for (int q = 0; q < old_count; ++q) {
    const int centre = out.node_count++;
    for (int i = 0; i < 4; ++i) {
      const int before = (i + 3) % 4, after = (i + 1) % 4;
      const int child = 4 * q + i;
      // Corner i is the patch's own; then counter-clockwise along side i, the centre, and back along the side before.
      out.nodes[child][i] = graph.nodes[q][i];
      out.nodes[child][after] = middle[q][i];
      out.nodes[child][(i + 2) % 4] = centre;
      out.nodes[child][before] = middle[q][before];
      out.neighbours[child][after] = {4 * q + after, before};
      out.neighbours[child][(i + 2) % 4] = {4 * q + before, i};
      // On side i the quadrant has the first half, on the side before it the second.
      const PatchSide first = graph.neighbours[q][i], second = graph.neighbours[q][before];
      out.neighbours[child][i] = first.patch < 0 ? PatchSide{} : PatchSide{4 * first.patch + (first.side + 1) % 4, first.side};
      out.neighbours[child][before] = second.patch < 0 ? PatchSide{} : PatchSide{4 * second.patch + second.side, second.side};
    }
  }
  return out;
}

std::vector<int> node_valences(const QuadGraph& graph) {
  std::vector<int> valence(graph.node_count, 0);
  for (const auto& nodes : graph.nodes)
    for (const int n : nodes) ++valence[n];
  return valence;
}

std::vector<char> boundary_nodes(const QuadGraph& graph) {
  std::vector<char> on(graph.node_count, 0);
  for (int q = 0; q < graph.patch_count(); ++q)
    for (int i = 0; i < 4; ++i)
      if (graph.neighbours[q][i].patch < 0) on[graph.nodes[q][i]] = on[graph.nodes[q][(i + 1) % 4]] = 1;
  return on;
}

}  // namespace hybrid_mesh
