// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Eppstein, Dynamic generators of topologically embedded graphs, 2003 (trees and co-trees); Erickson, Har-Peled, Optimally cutting a
// surface into a disk, 2004.
#include "topology/cohomology.h"

#include <algorithm>
#include <bit>
#include <boost/pending/disjoint_sets.hpp>

namespace hybrid_mesh {
namespace {

void add_to(BitVector& a, const BitVector& b) {
  for (std::size_t w = 0; w < a.size(); ++w) a[w] ^= b[w];
}

// Marks both half-edges of every edge that no breadth-first spanning forest of the points holds.
std::vector<char> edges_off_forest(const TriangleSurface& closed) {
  const int half_edges = 3 * static_cast<int>(closed.faces.size());
  std::vector<int> out(closed.points.size(), -1);
  for (int h = half_edges; h-- > 0;) out[closed.from(h)] = h;
  std::vector<char> off(half_edges, 1), seen(closed.points.size(), 0);
  std::vector<int> queue;
  for (std::size_t root = 0; root < closed.points.size(); ++root) {
    if (seen[root] || out[root] < 0) continue;
    queue.assign(1, static_cast<int>(root));
    seen[root] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      int h = out[queue[i]];
      do {
        if (!seen[closed.to(h)]) {
          seen[closed.to(h)] = 1;
          queue.push_back(closed.to(h));
          off[h] = off[closed.opposite[h]] = 0;
        }
        h = closed.opposite[TriangleSurface::previous(h)];
      } while (h != out[queue[i]]);
    }
  }
  return off;
}

// Takes away crossed edges of faces that have no other, until each face has none or more than one. Per face: how many it keeps.
std::vector<int> prune_leaves(const TriangleSurface& closed, std::vector<char>& crossed) {
  std::vector<int> degree(closed.faces.size(), 0), leaves;
  for (std::size_t h = 0; h < crossed.size(); ++h) degree[h / 3] += crossed[h];
  for (std::size_t f = 0; f < degree.size(); ++f)
    if (degree[f] == 1) leaves.push_back(static_cast<int>(f));
  while (!leaves.empty()) {
    int face = leaves.back();
    leaves.pop_back();
    if (degree[face] != 1) continue;
    int h = 3 * face;
    while (!crossed[h]) ++h;
    const int other = closed.opposite[h];
    crossed[h] = crossed[other] = 0;
    --degree[face];
    if (--degree[other / 3] == 1) leaves.push_back(other / 3);
  }
  return degree;
}

}  // namespace

void BitSpace::reduce(BitVector& vector) const {
  for (std::size_t w = 0; w < vector.size(); ++w)
    for (std::uint64_t left = vector[w]; left;) {
      const int bit = std::countr_zero(left);
      const int row = row_of_[64 * w + bit];
      // Rows have no bit before their first one.
      if (row >= 0) add_to(vector, rows_[row]);
      left = bit == 63 ? 0 : vector[w] & (~std::uint64_t{0} << (bit + 1));
    }
}

bool BitSpace::add(BitVector vector) {
  reduce(vector);
  for (std::size_t w = 0; w < vector.size(); ++w)
    if (vector[w]) {
      row_of_[64 * w + std::countr_zero(vector[w])] = dimension();
      rows_.push_back(std::move(vector));
      return true;
    }
  return false;
}

Cohomology::Cohomology(const TriangleSurface& closed, const Progress& progress) : chain_(closed.opposite.size(), -1) {
  std::vector<char> crossed = edges_off_forest(closed);
  progress(0.5);
  const std::vector<int> degree = prune_leaves(closed, crossed);
  progress(0.8);
  trace_chains(closed, crossed, degree);
  std::vector<int> node(closed.faces.size(), -1);
  int nodes = 0;
  for (auto& ends : nodes_)
    for (int& face : ends) {
      if (node[face] < 0) node[face] = nodes++;
      face = node[face];
    }
  number_cycles(nodes_, nodes);
  nodes_.clear();
  progress(1);
}

// What is left of a component of genus g > 0 has 2 g independent cycles: there are faces at which three chains meet.
void Cohomology::trace_chains(const TriangleSurface& closed, const std::vector<char>& crossed, const std::vector<int>& degree) {
  for (int start = 0; start < static_cast<int>(chain_.size()); ++start) {
    if (!crossed[start] || degree[start / 3] != 3 || chain_[start] >= 0) continue;
    const int name = static_cast<int>(nodes_.size());
    int h = start;
    for (;;) {
      const int across = closed.opposite[h];
      chain_[h] = chain_[across] = name;
      if (degree[across / 3] == 3) {
        nodes_.push_back({start / 3, across / 3});
        break;
      }
      h = TriangleSurface::next(across);
      if (!crossed[h]) h = TriangleSurface::next(h);
    }
  }
}

void Cohomology::number_cycles(std::vector<std::array<int, 2>>& ends, int nodes) {
  std::vector<int> rank(nodes, 0), parent(nodes);
  for (int n = 0; n < nodes; ++n) parent[n] = n;
  boost::disjoint_sets<int*, int*> sets(rank.data(), parent.data());
  std::vector<std::vector<int>> tree(nodes);  // per node: chains of the spanning forest
  std::vector<int> closing;
  for (int c = 0; c < static_cast<int>(ends.size()); ++c) {
    const auto [a, b] = ends[c];
    if (sets.find_set(a) == sets.find_set(b)) {
      closing.push_back(c);
      continue;
    }
    sets.union_set(a, b);
    tree[a].push_back(c);
    tree[b].push_back(c);
  }
  dimension_ = static_cast<int>(closing.size());
  const BitVector zero((dimension_ + 63) / 64, 0);
  bits_.assign(ends.size(), zero);
  std::vector<BitVector> at(nodes, zero);  // bits of the closing chains that leave what hangs on the node
  for (int i = 0; i < dimension_; ++i) {
    BitVector& bits = bits_[closing[i]];
    bits[i / 64] |= std::uint64_t{1} << (i % 64);
    add_to(at[ends[closing[i]][0]], bits);
    add_to(at[ends[closing[i]][1]], bits);
  }
  std::vector<int> up(nodes, -2), order;  // the chain to the parent, -1 for a root
  for (int root = 0; root < nodes; ++root) {
    if (up[root] != -2) continue;
    up[root] = -1;
    order.push_back(root);
    for (std::size_t i = order.size() - 1; i < order.size(); ++i)
      for (const int c : tree[order[i]]) {
        const int other = ends[c][0] == order[i] ? ends[c][1] : ends[c][0];
        if (up[other] != -2) continue;
        up[other] = c;
        order.push_back(other);
      }
  }
  for (std::size_t i = order.size(); i-- > 0;) {
    const int node = order[i], c = up[node];
    if (c < 0) continue;
    bits_[c] = at[node];
    add_to(at[ends[c][0] == node ? ends[c][1] : ends[c][0]], at[node]);
  }
}

}  // namespace hybrid_mesh
