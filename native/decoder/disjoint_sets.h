// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace hybrid_mesh {

// The numbers 0 .. count - 1 in sets that are joined step by step. One number of each set stands for it.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count = 0) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  std::size_t count() const { return parent_.size(); }
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // What stands for j's set stands for both then.
  void join(int i, int j) { parent_[find(i)] = find(j); }
  // A further number, in the set of i.
  void add_to(int i) { parent_.push_back(i); }
  bool is_representative(int i) const { return parent_[i] == i; }

 private:
  std::vector<int> parent_;
};

}  // namespace hybrid_mesh
