// SPDX-License-Identifier: GPL-3.0-or-later
// Answers to every query of a hierarchy found the long way: the sides of all leaves are cut into the finest pieces there are, and pieces are matched
// with their twins.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

class BruteForce {
 public:
  explicit BruteForce(const HybridMesh& mesh) : mesh_(mesh), leaves_(mesh.leaves()) {
    int halves = 0;
    for (int n = 0; n < mesh.node_count(); ++n)
      for (int s = 0; s < 4; ++s) halves = std::max(halves, (mesh.half_edge(n, s) | 1) + 1);
    // Which half-edges are split: those that are a side of a node with children.
    parts_.assign(halves, {-1, -1});
    for (int n = 0; n < mesh.node_count(); ++n) {
      const int child = mesh.first_child(n);
      for (int s = 0; child >= 0 && s < 4; ++s) {
        const HalfEdge h = mesh.half_edge(n, s), a = mesh.half_edge(child + s, s), b = mesh.half_edge(child + (s + 1) % 4, s);
        parts_[h] = {a, b};
        parts_[h ^ 1] = {b ^ 1, a ^ 1};
      }
    }
    held_.assign(halves, SideLink{});
    for (int n = 0; n < mesh.node_count(); ++n)
      for (int s = 0; s < 4 && mesh.is_active(n); ++s) {
        SideLink& held = held_[mesh.half_edge(n, s)];
        if (held.valid()) problems_.push_back("a half-edge is held twice");
        held = {n, s};
      }
    owner_.assign(halves, SideLink{});
    next_.assign(halves, -1);
    before_.assign(halves, -1);
    for (int leaf : leaves_) {
      std::vector<HalfEdge> loop;
      for (int s = 0; s < 4; ++s) {
        const std::size_t begin = loop.size();
        cut(mesh.half_edge(leaf, s), loop);
        for (std::size_t i = begin; i < loop.size(); ++i) {
          if (owner_[loop[i]].valid()) problems_.push_back("two leaves lie to the left of a half-edge");
          owner_[loop[i]] = {leaf, s};
        }
      }
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const HalfEdge following = loop[(i + 1) % loop.size()];
        if (mesh.to(loop[i]) != mesh.from(following)) problems_.push_back("the sides of a leaf do not follow each other");
        next_[loop[i]] = following;
        before_[following] = loop[i];
        leaving_[mesh.from(loop[i])].insert(leaf);
        pieces_.push_back(loop[i]);
      }
      for (int i = 0; i < 4; ++i) corners_.insert(mesh.corner(leaf, i));
    }
  }

  const std::vector<std::string>& problems() const { return problems_; }

  // Pieces between the same two vertices that are not one edge: sides that ought to be glued, or a second edge.
  int double_pieces() const {
    std::map<std::pair<VertexId, VertexId>, int> edge;
    int result = 0;
    for (HalfEdge h : pieces_)
      result += edge.try_emplace(std::minmax(mesh_.from(h), mesh_.to(h)), h >> 1).first->second != h >> 1 || mesh_.from(h) == mesh_.to(h);
    return result;
  }

  SideLink neighbour(int node, int side) const {
    const HalfEdge across = mesh_.half_edge(node, side) ^ 1;
    if (held_[across].valid()) return held_[across];
    std::vector<HalfEdge> pieces;
    cut(across, pieces);
    const SideLink owner = owner_[pieces[0]];
    for (HalfEdge h : pieces)
      if (owner_[h] != owner) return {};
    return owner.valid() && mesh_.level(owner.node) < mesh_.level(node) ? owner : SideLink{};
  }

  std::vector<SideLink> leaf_neighbours(int node, int side) const {
    std::vector<HalfEdge> pieces;
    cut(mesh_.half_edge(node, side), pieces);
    std::vector<SideLink> result;
    for (HalfEdge h : pieces) {
      const SideLink owner = owner_[h ^ 1];
      if (owner.valid() && (result.empty() || result.back() != owner)) result.push_back(owner);
    }
    return result;
  }

  bool has_finer_neighbour(int node, int side) const {
    for (const SideLink& other : leaf_neighbours(node, side))
      if (mesh_.level(other.node) > mesh_.level(node)) return true;
    return false;
  }

  // Counter-clockwise; where the vertex lies on a boundary from the first leaf after it, else from the leaf to the left of the node's side.
  std::vector<int> leaves_at_corner(int node, int corner) const {
    std::vector<HalfEdge> pieces;
    cut(mesh_.half_edge(node, corner), pieces);
    const HalfEdge start = pieces[0];
    HalfEdge first = start;
    for (std::size_t steps = 0; owner_[first ^ 1].valid() && steps <= pieces_.size(); ++steps) {  // clockwise
      first = next_[first ^ 1];
      if (first == start) break;
    }
    std::vector<int> result;
    HalfEdge h = first;
    for (std::size_t steps = 0; owner_[h].valid() && steps <= pieces_.size(); ++steps) {
      if (std::find(result.begin(), result.end(), owner_[h].node) == result.end()) result.push_back(owner_[h].node);
      h = before_[h] ^ 1;
      if (h == first) break;
    }
    return result;
  }

  // Whether a leaf has the vertex as a corner: all that had it may have been removed.
  bool is_used(VertexId vertex) const { return corners_.count(vertex) > 0; }

  // All leaves with a used vertex as a corner or inside a side, in no order.
  const std::set<int>& leaves_with(VertexId vertex) const { return leaving_.at(vertex); }

  SideLink removed_neighbour(int node, int side) const {
    const int o = mesh_.removed_by(node);
    if (o < 0) return {};
    const HybridMesh::Operation& operation = mesh_.operation(o);
    for (std::size_t q = 0; q < operation.roots.size(); ++q)
      for (int s = 0; s < 4; ++s) {
        const Repatch::Side& taken = operation.repatch.sides[q][s];
        if (taken.kind == Repatch::Side::Kind::Outer && taken.half == mesh_.half_edge(node, side)) return {operation.roots[q], s};
      }
    return {};
  }

  // A side with a corner of another leaf inside is cut in its middle, whatever lies there.
  HybridMesh::LeafCounts counts() const {
    std::set<VertexId> vertices = corners_;
    const auto cut_middle = [&](const auto& self, HalfEdge h) -> bool {
      if (parts_[h].first < 0) return false;
      const VertexId middle = mesh_.to(parts_[h].first);
      const bool left = self(self, parts_[h].first), right = self(self, parts_[h].second);
      if (!left && !right && !corners_.count(middle)) return false;
      vertices.insert(middle);
      return true;
    };
    for (int leaf : leaves_)
      for (int s = 0; s < 4; ++s) cut_middle(cut_middle, mesh_.half_edge(leaf, s));
    HybridMesh::LeafCounts result;
    result.vertices = static_cast<std::int64_t>(vertices.size());
    result.faces = static_cast<std::int64_t>(leaves_.size());
    // Edges run from one used vertex to the next; both sides see the same ones.
    std::set<int> edges;
    std::int64_t sides = 0;
    for (HalfEdge h : pieces_) {
      if (!vertices.count(mesh_.from(h))) continue;
      ++sides;
      int least = h >> 1;
      for (HalfEdge k = h; !vertices.count(mesh_.to(k));) {
        k = next_[k];
        least = std::min(least, k >> 1);
      }
      edges.insert(least);
    }
    result.hanging = sides - 4 * result.faces;
    result.euler = result.vertices - static_cast<std::int64_t>(edges.size()) + result.faces;
    return result;
  }

 private:
  void cut(HalfEdge h, std::vector<HalfEdge>& pieces) const {
    if (parts_[h].first < 0) {
      pieces.push_back(h);
      return;
    }
    cut(parts_[h].first, pieces);
    cut(parts_[h].second, pieces);
  }

  const HybridMesh& mesh_;
  std::vector<int> leaves_;
  std::vector<std::pair<HalfEdge, HalfEdge>> parts_;
  std::vector<SideLink> held_, owner_;   // per half-edge: the active node, the leaf to its left
  std::vector<HalfEdge> next_, before_;  // per piece: in the loop of its leaf
  std::vector<HalfEdge> pieces_;
  std::map<VertexId, std::set<int>> leaving_;
  std::set<VertexId> corners_;
  std::vector<std::string> problems_;
};

// Every query of every node against the answers above; the first difference in words, or an empty string.
inline std::string find_wrong_answer(const HybridMesh& mesh) {
  const BruteForce truth(mesh);
  if (!truth.problems().empty()) return truth.problems()[0];
  const auto name = [](const char* query, int n, int s) {
    return std::string(query) + " of node " + std::to_string(n) + ", side or corner " + std::to_string(s);
  };
  for (int n = 0; n < mesh.node_count(); ++n)
    for (int s = 0; s < 4; ++s) {
      if (mesh.removed_neighbour(n, s) != truth.removed_neighbour(n, s)) return name("removed_neighbour", n, s);
      if (!mesh.is_active(n)) continue;
      if (mesh.neighbour(n, s) != truth.neighbour(n, s)) return name("neighbour", n, s);
      if (mesh.leaf_neighbours(n, s) != truth.leaf_neighbours(n, s)) return name("leaf_neighbours", n, s);
      if (mesh.has_finer_neighbour(n, s) != truth.has_finer_neighbour(n, s)) return name("has_finer_neighbour", n, s);
      const std::vector<int> around = mesh.leaves_at_corner(n, s);
      if (mesh.is_leaf(n) && around != truth.leaves_at_corner(n, s)) return name("leaves_at_corner", n, s);
      const VertexId vertex = mesh.corner(n, s);
      if (truth.is_used(vertex) && std::set<int>(around.begin(), around.end()) != truth.leaves_with(vertex))
        return name("leaves_at_corner, in no order,", n, s);
    }
  const HybridMesh::LeafCounts a = mesh.leaf_counts(), b = truth.counts();
  if (a.vertices != b.vertices || a.faces != b.faces || a.hanging != b.hanging || a.euler != b.euler) return "leaf_counts";
  return "";
}

}  // namespace hybrid_mesh
