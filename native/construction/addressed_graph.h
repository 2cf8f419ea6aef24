// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "layout/layout_edit.h"

namespace hybrid_mesh {

// The place of a quad in a hierarchy: the number of its root quad (those of the base first, then the new quads of every edit in order), and for each
// level from there on the child that is taken, as in "12.0.3".
struct QuadAddress {
  int root = 0;
  std::uint64_t path = 1;  // a leading 1, then two bits a child

  QuadAddress child(int k) const { return {root, 4 * path + static_cast<std::uint64_t>(k)}; }
  friend bool operator==(const QuadAddress&, const QuadAddress&) = default;
};
std::string to_string(const QuadAddress& address);

// The quads of one level, each with its address.
class AddressedGraph {
 public:
  explicit AddressedGraph(const QuadGraph& base);
  // `roots`: how many numbers root quads have had.
  AddressedGraph(QuadGraph graph, std::vector<QuadAddress> addresses, int roots);

  const QuadGraph& graph() const { return graph_; }
  const QuadAddress& address(int patch) const { return address_[patch]; }
  int find(const std::string& address) const;  // the patch, -1: none
  void quadrisect();
  // See change_layout().
  LayoutChange apply(const LayoutEdit& edit);

 private:
  QuadGraph graph_;
  std::vector<QuadAddress> address_;
  int roots_ = 0;
  mutable std::unordered_map<std::string, int> patch_at_;  // made when first needed
};

}  // namespace hybrid_mesh
