// SPDX-License-Identifier: GPL-3.0-or-later
// Who lies across a side of a quad and around its corners, in a mesh whose quads are of several levels: links are found by climbing from a half-edge
// to the nearest one that is held, and by descending to the finest ones below it.
#include <algorithm>

#include "decoder/forest/quad_forest.h"

namespace hybrid_mesh {

// The active node that has a half-edge as a side, or the coarser leaf that has it as a part of a side.
SideLink QuadForest::holder_or_coarser(HalfEdge h) const {
  if (holder_[h] >= 0) return {holder_[h] / 4, holder_[h] % 4};
  for (h = half_parent(h); h >= 0; h = half_parent(h)) {
    const int k = holder_[h];
    if (k < 0) continue;
    // A refined node whose descendants do not hold the half-edge has lost them there to an operation.
    if (nodes_[k / 4].child >= 0) break;
    return {k / 4, k % 4};
  }
  return {};
}

SideLink QuadForest::neighbour(int node, int side) const { return holder_or_coarser(nodes_[node].half[side] ^ 1); }

SideLink QuadForest::removed_neighbour(int node, int side) const {
  const int op = removed_by(node);
  if (op < 0) return {};
  const HalfEdge h = nodes_[node].half[side];
  for (int root : operations_[op].roots)
    for (int s = 0; s < 4; ++s)
      if (nodes_[root].half[s] == h) return {root, s};
  return {};
}

std::vector<SideLink> QuadForest::leaf_neighbours(int node, int side) const {
  std::vector<SideLink> result;
  const HalfEdge across = nodes_[node].half[side] ^ 1;
  const SideLink coarse = holder_or_coarser(across);
  if (coarse.valid() && nodes_[coarse.node].child < 0) return {coarse};
  // Parts in the direction of the twin; reversed at the end.
  std::vector<HalfEdge> stack{across};
  while (!stack.empty()) {
    const HalfEdge h = stack.back();
    stack.pop_back();
    if (holder_[h] >= 0 && nodes_[holder_[h] / 4].child < 0) {
      result.push_back({holder_[h] / 4, holder_[h] % 4});
    } else if (edges_[h >> 1].child >= 0) {
      stack.push_back(half_child(h, 0));
      stack.push_back(half_child(h, 1));
    }
  }
  return result;
}

// Whether an active node holds a part of the half-edge.
bool QuadForest::finer(HalfEdge h) const {
  if (edges_[h >> 1].child < 0) return false;
  for (int part = 0; part < 2; ++part) {
    const HalfEdge c = half_child(h, part);
    if (holder_[c] >= 0 || finer(c)) return true;
  }
  return false;
}

// A refined node across may have lost all its quads there to an operation: a leaf has to hold a part of the side.
bool QuadForest::has_finer_neighbour(int node, int side) const {
  const auto leaf_below = [this](const auto& self, HalfEdge h) -> bool {
    if (edges_[h >> 1].child < 0) return false;
    for (int part = 0; part < 2; ++part) {
      const HalfEdge c = half_child(h, part);
      if ((holder_[c] >= 0 && nodes_[holder_[c] / 4].child < 0) || self(self, c)) return true;
    }
    return false;
  };
  return leaf_below(leaf_below, nodes_[node].half[side] ^ 1);
}

HalfEdge QuadForest::descend(HalfEdge h, int cap) const {
  while (edges_[h >> 1].child >= 0 && edges_[h >> 1].level < cap) h = half_child(h, 0);
  return h;
}

QuadForest::Sector QuadForest::sector_left(HalfEdge leaving, int cap) const {
  Sector sector;
  HalfEdge bent = -1;  // set once the vertex lies inside the side climbed to
  for (HalfEdge h = leaving; h >= 0;) {
    const int k = holder_[h];
    if (k >= 0) {
      const Node& node = nodes_[k / 4];
      if (node.level < cap && node.child >= 0) return {};
      sector.node = k / 4;
      sector.corner = bent < 0 ? k % 4 : -1;
      sector.next = descend(bent < 0 ? node.half[(k + 3) % 4] ^ 1 : bent, cap);
      return sector;
    }
    const HalfEdge up = half_parent(h);
    if (up >= 0 && bent < 0 && part_of_parent(h) == 1) bent = half_child(up, 0) ^ 1;
    h = up;
  }
  return {};
}

QuadForest::Sector QuadForest::sector_right(HalfEdge leaving, int cap) const {
  Sector sector;
  HalfEdge bent = -1;
  for (HalfEdge h = leaving ^ 1; h >= 0;) {
    const int k = holder_[h];
    if (k >= 0) {
      const Node& node = nodes_[k / 4];
      if (node.level < cap && node.child >= 0) return {};
      sector.node = k / 4;
      sector.corner = bent < 0 ? (k + 1) % 4 : -1;
      sector.next = descend(bent < 0 ? node.half[(k + 1) % 4] : bent, cap);
      return sector;
    }
    const HalfEdge up = half_parent(h);
    if (up >= 0 && bent < 0 && part_of_parent(h) == 0) bent = half_child(up, 1);
    h = up;
  }
  return {};
}

std::vector<int> QuadForest::leaves_at_corner(int node, int corner) const {
  std::vector<int> after, before;
  const auto visit = [&](int leaf, bool clockwise) { (clockwise ? before : after).push_back(leaf); };
  visit_corner(node, corner, visit);
  if (after.empty() && before.empty()) {
    // The quads on both sides of a refined node's side were removed; what is left around the vertex has other edges.
    const VertexId vertex = this->corner(node, corner);
    for (int leaf : leaves())
      for (int i = 0; i < 4 && after.empty(); ++i)
        if (this->corner(leaf, i) == vertex) visit_corner(leaf, i, visit);
  }
  std::reverse(before.begin(), before.end());
  before.insert(before.end(), after.begin(), after.end());
  std::vector<int> result;
  for (int leaf : before)
    if (std::find(result.begin(), result.end(), leaf) == result.end()) result.push_back(leaf);
  return result;
}

}  // namespace hybrid_mesh
