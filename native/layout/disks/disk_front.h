// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdlib>
#include <vector>

#include "layout/disks/disk_layout.h"

namespace hybrid_mesh {

// The boundary of what is still empty, and the quads laid so far. It begins as the boundary of the disk and is done when nothing is left of it.
class DiskFront {
 public:
  explicit DiskFront(const std::vector<int>& quads_at) : boundary_nodes_(static_cast<int>(quads_at.size())), length_(boundary_nodes_) {
    for (int i = 0; i < boundary_nodes_; ++i)
      nodes_.push_back({(i + 1) % boundary_nodes_, (i + boundary_nodes_ - 1) % boundary_nodes_, quads_at[i], 0, 0, i, i, true});
  }

  bool done() const { return length_ == 0; }
  bool failed() const { return failed_; }
  int length() const { return length_; }
  int quad_count() const { return static_cast<int>(quads_.size()); }
  // Inner nodes with other than four quads, so far.
  int irregular() const { return irregular_; }
  int boundary_nodes() const { return boundary_nodes_; }
  // Nodes of the disk's boundary that still lack quads.
  int boundary_length() const {
    int count = 0;
    for (int v : loop()) count += nodes_[v].on_boundary;
    return count;
  }
  int lacking(int v) const { return nodes_[v].total - nodes_[v].used; }
  std::vector<int> loop() const {
    std::vector<int> result;
    int v = start_;
    for (int i = 0; i < length_; ++i, v = nodes_[v].next) result.push_back(v);
    return result;
  }
  // After a failure: the boundary nodes, first those whose wishes led to it most likely.
  const std::vector<int>& blamed() const { return blamed_; }

  bool may_deviate(int v, int by) const {
    const Node& node = nodes_[v];
    return !node.on_boundary && std::abs(node.total + by - 4) <= 1 && lacking(v) + by >= 0;
  }
  void deviate(int v, int by) {
    Node& node = nodes_[v];
    irregular_ += (node.total + by != 4) - (node.total != 4);
    node.total += by;
  }

  // Gives a node all the quads that it lacks, at least one.
  void close(int a);
  // Makes one edge of the two at a node that lacks no quad.
  void zip(int a);
  // Zips until every node lacks a quad. False if that failed.
  bool settle();
  // Makes one edge of a front of two, whose nodes may take one quad fewer for it.
  void join_last_edges();
  // Lays quads along the whole front: closes all its nodes, corners first. False if what they lack contradicts each other.
  bool lay_ring();
  // Fills a front that turns by 4, 3 or 5 right angles with regular nodes and, for the latter two, one inner node of three or five quads. False if
  // that cannot be.
  bool fill();
  DiskLayout layout() const;

 private:
  struct Node {
    int next, before;
    int total, used;  // quads around it in the end, so far
    int ring;
    int same_as;  // itself, or the node that it became one with
    int origin;   // a boundary node near it
    bool on_boundary;
  };

  int add_node(int used, int origin) {
    const int v = static_cast<int>(nodes_.size());
    nodes_.push_back({-1, -1, 4, used, ring_ + 1, v, origin, false});
    return v;
  }
  void link(int u, int v) {
    nodes_[u].next = v;
    nodes_[v].before = u;
  }

  void fail(int at);

  std::vector<Node> nodes_;
  std::vector<std::array<int, 4>> quads_;
  std::vector<int> blamed_;
  int boundary_nodes_, length_, start_ = 0, ring_ = 0, irregular_ = 0;
  bool failed_ = false;
};

}  // namespace hybrid_mesh
