// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/level_quads.h"

#include "decoder/forest/vertex_index.h"

namespace hybrid_mesh {

namespace {

void find_edges(const QuadForest& forest, LevelQuads& quads) {
  const std::size_t sides = 4 * quads.node.size();
  quads.half.resize(sides);
  quads.edge.reserve(sides / 2 + 64);
  quads.side.reserve(sides / 2 + 64);
  // Edges of a level have numbers side by side as a rule.
  int least = 0, most = -1;
  for (const int node : quads.node)
    for (int i = 0; i < 4; ++i) {
      const int e = forest.half_edge(node, i) >> 1;
      least = most < 0 || e < least ? e : least;
      most = e > most ? e : most;
    }
  std::vector<int> number(most - least + 1, -1);
  int at = 0;
  for (const int node : quads.node)
    for (int i = 0; i < 4; ++i, ++at) {
      const HalfEdge h = forest.half_edge(node, i);
      int& e = number[(h >> 1) - least];
      if (e < 0) {
        e = quads.edge_count();
        quads.edge.push_back(h >> 1);
        quads.side.push_back({-1, -1});
      }
      quads.half[at] = 2 * e + (h & 1);
      quads.side[e][h & 1] = at;
    }
  quads.across.resize(sides);
  for (std::size_t s = 0; s < sides; ++s) quads.across[s] = quads.side[quads.half[s] >> 1][(quads.half[s] & 1) ^ 1];
}

void find_vertices(const QuadForest& forest, const std::vector<VertexId>& vertices, LevelQuads& quads) {
  const VertexIndex find(vertices);
  std::vector<int> number(vertices.size(), -1);
  quads.in_mesh.reserve(vertices.size());
  const auto numbered = [&](VertexId name) {
    const int v = find(name);
    if (number[v] < 0) {
      number[v] = quads.vertex_count();
      quads.in_mesh.push_back(v);
    }
    return number[v];
  };
  quads.vertex.resize(quads.half.size());
  const int count = static_cast<int>(quads.half.size());
  for (int s = 0, met = 0; s < count; ++s) {
    const int half = quads.half[s];
    int from = -1;
    // An edge is met for the first time where its number is the next one.
    if (half >> 1 == met) {
      ++met;
      const HalfEdge forwards = 2 * quads.edge[half >> 1];
      const int first = numbered(forest.from(forwards)), second = numbered(forest.to(forwards));
      from = half & 1 ? second : first;
    } else {
      from = numbered(forest.corner(quads.node[s / 4], s % 4));
    }
    quads.vertex[s] = from;
  }
}

}  // namespace

void count_around(LevelQuads& quads) {
  quads.start.assign(quads.vertex_count(), -1);
  quads.valence.assign(quads.vertex_count(), 0);
  quads.creases.assign(quads.vertex_count(), 0);
  const int count = static_cast<int>(quads.half.size());
  for (int c = 0; c < count; ++c) {
    const int v = quads.vertex[c];
    ++quads.valence[v];
    if (quads.start[v] < 0 || quads.across[c] < 0) quads.start[v] = c;
  }
  for (int e = 0; e < quads.edge_count(); ++e)
    if (quads.sharp[e] || quads.is_boundary(e))
      for (int i = 0; i < 2; ++i) ++quads.creases[quads.end(e, i)];
}

LevelQuads level_quads(const QuadForest& forest, const std::vector<int>& nodes, const std::vector<VertexId>& vertices, int level) {
  LevelQuads quads;
  quads.node.reserve(nodes.size());
  for (const int node : nodes)
    if (forest.level(node) == level && (quads.node.empty() || quads.node.back() != node)) quads.node.push_back(node);
  find_edges(forest, quads);
  quads.sharp.assign(quads.edge.size(), 0);
  if (forest.has_sharp_sides())
    for (std::size_t e = 0; e < quads.edge.size(); ++e) quads.sharp[e] = forest.is_sharp_edge(quads.edge[e]);
  find_vertices(forest, vertices, quads);
  count_around(quads);
  return quads;
}

}  // namespace hybrid_mesh
