// SPDX-License-Identifier: GPL-3.0-or-later
#include "construction/addressed_graph.h"

#include <utility>

namespace hybrid_mesh {

std::string to_string(const QuadAddress& address) {
  std::string children;
  for (std::uint64_t path = address.path; path > 1; path /= 4) children = "." + std::to_string(path % 4) + children;
  return std::to_string(address.root) + children;
}

AddressedGraph::AddressedGraph(const QuadGraph& base) : graph_(base), roots_(base.patch_count()) {
  for (int q = 0; q < roots_; ++q) address_.push_back({q, 1});
}

AddressedGraph::AddressedGraph(QuadGraph graph, std::vector<QuadAddress> addresses, int roots)
    : graph_(std::move(graph)), address_(std::move(addresses)), roots_(roots) {}

int AddressedGraph::find(const std::string& address) const {
  if (patch_at_.empty())
    for (int q = 0; q < graph_.patch_count(); ++q) patch_at_[to_string(address_[q])] = q;
  const auto at = patch_at_.find(address);
  return at == patch_at_.end() ? -1 : at->second;
}

void AddressedGraph::quadrisect() {
  graph_ = quadrisected(graph_);
  std::vector<QuadAddress> finer;
  for (const QuadAddress& a : address_)
    for (int k = 0; k < 4; ++k) finer.push_back(a.child(k));
  address_ = std::move(finer);
  patch_at_.clear();
}

LayoutChange AddressedGraph::apply(const LayoutEdit& edit) {
  LayoutChange change = change_layout(graph_, edit);
  std::vector<QuadAddress> addresses(graph_.patch_count());
  for (std::size_t q = 0; q < change.patch.size(); ++q)
    if (change.patch[q] >= 0) addresses[change.patch[q]] = address_[q];
  for (const int q : change.added) addresses[q] = {roots_++, 1};
  address_ = std::move(addresses);
  patch_at_.clear();
  return change;
}

}  // namespace hybrid_mesh
