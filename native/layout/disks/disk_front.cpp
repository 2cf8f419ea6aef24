// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/disks/disk_front.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "layout/disks/grid_region.h"

namespace hybrid_mesh {

void DiskFront::close(int a) {
  const int u = nodes_[a].before, v = nodes_[a].next, count = lacking(a);
  if (length_ < 4) return fail(a);
  // The quads go around `a` from v to u. Of each the corner opposite `a` and, but for the last, the one after it are new.
  int last = v;
  for (int k = 1; k <= count; ++k) {
    const int tip = add_node(1, nodes_[a].origin), after = k < count ? add_node(2, nodes_[a].origin) : u;
    quads_.push_back({a, last, tip, after});
    link(tip, last);
    link(after, tip);
    last = after;
  }
  nodes_[u].used += 1;
  nodes_[v].used += 1;
  start_ = u;
  length_ += 2 * (count - 1);
  if (lacking(u) < 0) fail(u);
  if (lacking(v) < 0) fail(v);
}

void DiskFront::zip(int a) {
  const int u = nodes_[a].before, v = nodes_[a].next;
  if (length_ == 2) {
    if (lacking(u) != 0) return fail(a);
    length_ = 0;
    return;
  }
  if (nodes_[u].on_boundary && nodes_[v].on_boundary) return fail(a);
  const int kept = nodes_[v].on_boundary ? v : u, gone = kept == u ? v : u;
  Node& node = nodes_[kept];
  const int off = nodes_[gone].total - 4;
  if (off != 0 && node.on_boundary) return fail(a);
  if (off != 0) {
    deviate(gone, -off);
    deviate(kept, off);
  }
  node.used += nodes_[gone].used;
  node.ring = std::min(node.ring, nodes_[gone].ring);
  link(nodes_[u].before, kept);
  link(kept, nodes_[v].next);
  nodes_[gone].same_as = kept;
  start_ = kept;
  length_ -= 2;
  if (lacking(kept) < 0 && may_deviate(kept, 1)) deviate(kept, 1);
  if (lacking(kept) < 0 || (!node.on_boundary && std::abs(node.total - 4) > 1)) fail(kept);
}

bool DiskFront::settle() {
  int steps = length_;
  for (int v = start_; !failed_ && length_ > 0 && steps > 0; --steps) {
    if (lacking(v) == 0) {
      zip(v);
      v = start_;
      steps = length_ + 1;
    } else {
      v = nodes_[v].next;
    }
  }
  return !failed_;
}

void DiskFront::join_last_edges() {
  for (int v : loop())
    if (lacking(v) > 0 && may_deviate(v, -lacking(v))) deviate(v, -lacking(v));
  if (lacking(start_) != 0) return fail(start_);
  zip(start_);
}

bool DiskFront::lay_ring() {
  while (!failed_ && length_ > 0) {
    int best = -1, best_rank = 4;
    int v = start_;
    for (int i = 0; i < length_; ++i, v = nodes_[v].next) {
      if (nodes_[v].ring > ring_) continue;
      // Others come last, and are met from a side that has its row.
      const int rank = lacking(v) <= 1 ? lacking(v) : 2 + (nodes_[nodes_[v].before].ring <= ring_ && nodes_[nodes_[v].next].ring <= ring_);
      if (rank < best_rank) best = v, best_rank = rank;
      if (rank == 0) break;
    }
    if (best < 0) {
      ++ring_;
      return settle();
    }
    if (best_rank == 0)
      zip(best);
    else
      close(best);
  }
  return !failed_;
}

bool DiskFront::fill() {
  if (!settle()) return false;
  if (length_ == 0) return true;
  const std::vector<int> nodes = loop();
  std::vector<int> lacks;
  for (int v : nodes) lacks.push_back(lacking(v));
  const GridWalk walk(lacks);
  const std::optional<std::vector<std::array<int, 4>>> cells = cells_inside(walk);
  if (!cells) return false;
  std::vector<int> inner;
  for (const auto& corners : *cells) {
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) {
      const int c = corners[i], k = c - length_;
      while (k >= static_cast<int>(inner.size())) inner.push_back(add_node(0, 0));
      quad[i] = k < 0 ? nodes[c] : inner[k];
      ++nodes_[quad[i]].used;
    }
    quads_.push_back(quad);
  }
  irregular_ += walk.turns != 4;
  length_ = 0;
  return true;
}

DiskLayout DiskFront::layout() const {
  std::vector<int> number(nodes_.size(), -1);
  for (int i = 0; i < boundary_nodes_; ++i) number[i] = i;
  DiskLayout result;
  for (const auto& quad : quads_) {
    std::array<int, 4> named;
    for (int i = 0; i < 4; ++i) {
      int v = quad[i];
      while (nodes_[v].same_as != v) v = nodes_[v].same_as;
      if (number[v] < 0) number[v] = boundary_nodes_ + result.inner_nodes++;
      named[i] = number[v];
    }
    result.quads.push_back(named);
  }
  return result;
}

void DiskFront::fail(int at) {
  failed_ = true;
  // What happened here depends most on the boundary from the one neighbour to the other, and there on what is near.
  const int n = boundary_nodes_, from = nodes_[nodes_[at].before].origin, middle = nodes_[at].origin, to = nodes_[nodes_[at].next].origin;
  const auto apart = [n](int i, int j) { return std::min((i - j + n) % n, (j - i + n) % n); };
  std::vector<std::pair<int, int>> order;
  bool between = true;
  for (int k = 0; k < n; ++k) {
    const int i = (from + k) % n;
    order.emplace_back((between ? 0 : n) + std::min({apart(i, from), apart(i, middle), apart(i, to)}), i);
    between &= i != to;
  }
  std::sort(order.begin(), order.end());
  blamed_.clear();
  for (const auto& [distance, i] : order) blamed_.push_back(i);
}

}  // namespace hybrid_mesh
