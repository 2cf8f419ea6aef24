// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Remacle et al., Blossom-Quad, 2012 (quads from a minimum-cost perfect matching of triangles).
#include "layout/base/triangle_pairing.h"

#include <lemon/list_graph.h>
#include <lemon/matching.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace hybrid_mesh {

std::vector<int> pair_triangles(int n, const std::vector<PairCandidate>& candidates) {
  // The graph and its mirror image, joined where a face may stay alone: each face's own choice is read from the first copy.
  using Graph = lemon::ListGraph;
  Graph graph;
  std::vector<Graph::Node> nodes;
  const bool mirrored = std::any_of(candidates.begin(), candidates.end(), [](const PairCandidate& c) { return c.b < 0; });
  const int copies = mirrored ? 2 : 1;
  for (int i = 0; i < copies * n; ++i) nodes.push_back(graph.addNode());
  Graph::EdgeMap<std::int64_t> weight(graph);
  Graph::EdgeMap<int> candidate(graph);
  for (int i = 0; i < static_cast<int>(candidates.size()); ++i) {
    const PairCandidate& c = candidates[i];
    const auto scaled = static_cast<std::int64_t>(std::llround(c.weight * 1e6));
    const auto add = [&](int a, int b, std::int64_t w) {
      const Graph::Edge e = graph.addEdge(nodes[a], nodes[b]);
      weight[e] = w;
      candidate[e] = i;
    };
    if (c.b < 0) {
      add(c.a, c.a + n, 2 * scaled);
    } else {
      add(c.a, c.b, scaled);
      if (mirrored) add(c.a + n, c.b + n, scaled);
    }
  }
  lemon::MaxWeightedPerfectMatching<Graph, Graph::EdgeMap<std::int64_t>> matching(graph, weight);
  if (!matching.run()) throw NoMap("the base triangles have no perfect matching");
  std::vector<int> choice(n, -1);
  for (int i = 0; i < n; ++i) choice[i] = candidate[matching.matching(nodes[i])];
  return choice;
}

}  // namespace hybrid_mesh
