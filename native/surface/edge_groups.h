// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

namespace hybrid_mesh {

// Half-edges gathered by the edge they run along: those of edge e are half_edges[begin[e]] .. half_edges[begin[e + 1] - 1], ascending.
// Edges are ordered by their smaller end, then by their larger one.
struct EdgeGroups {
  std::vector<int> half_edges;
  std::vector<int> begin{0};

  int count() const { return static_cast<int>(begin.size()) - 1; }
  int size(int edge) const { return begin[edge + 1] - begin[edge]; }
  const int* of(int edge) const { return half_edges.data() + begin[edge]; }
};

// `from` and `to` give the ends of a half-edge, in [0, point_count).
template <class From, class To>
EdgeGroups group_edges(int point_count, int half_edge_count, From from, To to) {
  struct End {
    int other, half_edge;
  };
  // A counting sort by the smaller end, then a sort of its few edges.
  std::vector<int> first(static_cast<std::size_t>(point_count) + 1, 0);
  for (int h = 0; h < half_edge_count; ++h) ++first[std::min(from(h), to(h)) + 1];
  for (int v = 0; v < point_count; ++v) first[v + 1] += first[v];
  std::vector<End> ends(half_edge_count);
  std::vector<int> fill(first.begin(), first.end() - 1);
  for (int h = 0; h < half_edge_count; ++h) {
    const int a = from(h), b = to(h);
    ends[fill[std::min(a, b)]++] = {std::max(a, b), h};
  }
  EdgeGroups groups;
  groups.half_edges.resize(half_edge_count);
  groups.begin.reserve(half_edge_count / 2 + 1);
  for (int v = 0; v < point_count; ++v) {
    std::sort(ends.begin() + first[v], ends.begin() + first[v + 1],
              [](const End& a, const End& b) { return a.other != b.other ? a.other < b.other : a.half_edge < b.half_edge; });
    for (int i = first[v]; i < first[v + 1]; ++i) {
      if (i > first[v] && ends[i].other != ends[i - 1].other) groups.begin.push_back(i);
      groups.half_edges[i] = ends[i].half_edge;
    }
    if (first[v + 1] > first[v]) groups.begin.push_back(first[v + 1]);
  }
  return groups;
}

}  // namespace hybrid_mesh
