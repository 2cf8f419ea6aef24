// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/plain_levels.h"

#include <array>
#include <utility>

namespace hybrid_mesh {

PlainLevels::PlainLevels(const QuadForest& base, LevelMesh mesh)
    : mesh_(std::move(mesh)), quads_(level_quads(base, mesh_.node, mesh_.vertex, 0)), nodes_(base.node_count()), edges_(base.edge_count()) {}

// Child k of a quad is at its corner k, and its sides have the same directions: side k is the first half of the quad's side k, side k + 1 leads from
// the middle of that to the centre, side k + 2 from there to the middle of side k - 1, whose second half is side k - 1.
void PlainLevels::number_edges(LevelQuads& fine) {
  const std::size_t quads = 4 * static_cast<std::size_t>(quads_.quad_count()), edges = 2 * quads_.edge.size() + quads;
  fine.half.resize(4 * quads);
  fine.edge.resize(edges);
  fine.side.assign(edges, {-1, -1});
  fine.sharp.assign(edges, 0);
  // Of the halves of this level's edges: what they are in the forest, and the number that they get when they are met.
  std::vector<int> in_forest(quads_.edge.size(), -1);
  std::vector<std::array<int, 2>> number(quads_.edge.size(), {-1, -1});
  int met = 0, at = 0;
  for (int q = 0; q < quads_.quad_count(); ++q) {
    const int* const half = &quads_.half[4 * static_cast<std::size_t>(q)];
    for (int s = 0; s < 4; ++s)
      if (int& first = in_forest[half[s] >> 1]; first < 0) {
        first = edges_;
        edges_ += 2;
      }
    const int inner_in_forest = edges_;
    edges_ += 4;
    std::array<int, 4> inner{-1, -1, -1, -1};  // from the middle of side k to the centre
    const auto met_half = [&](int side, int part) {
      const int h = half[side], e = h >> 1, place = part ^ (h & 1);
      int& n = number[e][place];
      if (n < 0) {
        n = met++;
        fine.edge[n] = in_forest[e] + place;
        fine.sharp[n] = quads_.sharp[e];
      }
      return 2 * n + (h & 1);
    };
    const auto met_inner = [&](int k) {
      int& n = inner[k];
      if (n < 0) {
        n = met++;
        fine.edge[n] = inner_in_forest + k;
      }
      return 2 * n;
    };
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 4; ++i, ++at) {
        const int before = (k + 3) & 3, turn = (i - k) & 3;
        const int h = turn == 0 ? met_half(k, 0) : turn == 1 ? met_inner(k) : turn == 2 ? met_inner(before) ^ 1 : met_half(before, 1);
        fine.half[at] = h;
        fine.side[h >> 1][h & 1] = at;
      }
  }
  fine.across.resize(fine.half.size());
  for (std::size_t s = 0; s < fine.half.size(); ++s) fine.across[s] = fine.side[fine.half[s] >> 1][(fine.half[s] & 1) ^ 1];
}

std::vector<int> PlainLevels::number_vertices(LevelMesh& fine) const {
  const int corners = quads_.vertex_count(), midpoints = quads_.edge_count(), quads = quads_.quad_count();
  std::vector<int> vertex_at(corners + midpoints + quads, -1);
  fine.indices.resize(16 * static_cast<std::size_t>(quads));
  fine.offsets.resize(4 * static_cast<std::size_t>(quads) + 1);
  fine.node.resize(4 * static_cast<std::size_t>(quads));
  fine.vertex.resize(vertex_at.size());
  int met = 0;
  const auto numbered = [&](int row, VertexId name) {
    int& v = vertex_at[row];
    if (v < 0) {
      v = met++;
      fine.vertex[v] = name;
    }
    return v;
  };
  std::int32_t* at = fine.indices.data();
  for (int q = 0; q < quads; ++q) {
    const int first = 4 * q;
    const auto corner = [&](int k) {
      const int v = quads_.vertex[first + k];
      return numbered(v, mesh_.vertex[quads_.in_mesh[v]]);
    };
    const auto middle = [&](int k) {
      const int e = quads_.edge_at(first + k);
      return numbered(corners + e, VertexId(VertexId::Kind::Edge, quads_.edge[e]));
    };
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 4; ++i) {
        const int turn = (i - k) & 3;
        *at++ = turn == 0   ? corner(k)
                : turn == 1 ? middle(k)
                : turn == 2 ? numbered(corners + midpoints + q, VertexId(VertexId::Kind::Node, quads_.node[q]))
                            : middle((k + 3) & 3);
      }
    for (int k = 0; k < 4; ++k) fine.node[first + k] = nodes_ + first + k;
  }
  for (std::size_t f = 0; f < fine.offsets.size(); ++f) fine.offsets[f] = 4 * static_cast<std::int64_t>(f);
  return vertex_at;
}

void PlainLevels::number_corners(const LevelMesh& fine_mesh, LevelQuads& fine) const {
  std::vector<int> number(fine_mesh.vertex_count(), -1);
  fine.in_mesh.resize(fine_mesh.vertex_count());
  int met = 0;
  const auto numbered = [&](int v) {
    if (number[v] < 0) {
      number[v] = met;
      fine.in_mesh[met++] = v;
    }
  };
  for (const auto& [forwards, backwards] : fine.side) {
    const int side = forwards >= 0 ? forwards : backwards;
    const int from = fine_mesh.indices[side], to = fine_mesh.indices[LevelQuads::next(side)];
    numbered(forwards >= 0 ? from : to);
    numbered(forwards >= 0 ? to : from);
  }
  fine.vertex.resize(fine.half.size());
  for (std::size_t c = 0; c < fine.vertex.size(); ++c) fine.vertex[c] = number[fine_mesh.indices[c]];
}

PlainLevels::Step PlainLevels::refine(bool last) {
  LevelMesh mesh;
  std::vector<int> rows = number_vertices(mesh);
  LevelQuads fine;
  const bool sharp = !mesh_.sharp.empty();
  if (!last || sharp) number_edges(fine);
  if (sharp)
    for (const int half : fine.half) mesh.sharp.push_back(fine.sharp[half >> 1]);
  if (!last) {
    fine.node = mesh.node;
    number_corners(mesh, fine);
    count_around(fine);
  }
  nodes_ += static_cast<int>(mesh.node.size());
  return {std::exchange(mesh_, std::move(mesh)), std::exchange(quads_, std::move(fine)), std::move(rows)};
}

}  // namespace hybrid_mesh
