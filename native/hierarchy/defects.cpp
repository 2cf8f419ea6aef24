// SPDX-License-Identifier: GPL-3.0-or-later
// The invariants of a hierarchy, in one place.
#include <algorithm>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// A friend of HybridMesh: looks at what is stored rather than at what queries answer.
class HierarchyAccess {
 public:
  explicit HierarchyAccess(const HybridMesh& mesh) : mesh_(mesh) {}

  std::vector<std::string> find_defects() {
    check_trees();
    check_edges();
    check_operations();
    if (defects_.empty()) {  // the queries below trust what was checked above
      check_holders();
      check_neighbours();
      check_balance();
      check_manifolds();
      check_counts();
    }
    check_maps();
    return defects_;
  }

 private:
  static constexpr std::size_t most_ = 50;  // more defects than these say nothing new

  void add(const std::string& what) {
    if (defects_.size() < most_) defects_.push_back(what);
  }
  static std::string name(int node) { return "node " + std::to_string(node); }
  static std::string name(int node, int side) { return "side " + std::to_string(side) + " of node " + std::to_string(node); }

  void check_trees() {
    const int count = mesh_.node_count();
    std::vector<char> is_child(count, 0);
    for (int n = 0; n < count; ++n) {
      const auto& node = mesh_.nodes_[n];
      if (node.child >= 0) {
        if (node.child <= n || node.child + 4 > count) {
          add(name(n) + " has children out of range");
          continue;
        }
        for (int c = node.child; c < node.child + 4; ++c) {
          if (is_child[c]) add(name(c) + " is the child of two nodes");
          is_child[c] = 1;
          const auto& child = mesh_.nodes_[c];
          if (child.parent != n) add(name(c) + " does not know its parent");
          if (child.level != node.level + 1) add(name(c) + " is not one level below its parent");
          if (child.root != node.root) add(name(c) + " has another root than its parent");
        }
      }
      if (node.parent < 0) {
        if (node.root != n) add(name(n) + " is a root with another root");
        if (n < mesh_.base_count_ ? node.level != 0 || node.operation >= 0 : node.operation < 0 || node.operation >= mesh_.operation_count())
          add(name(n) + " is a root made by neither the base nor an operation");
      }
    }
    for (int n = 0; n < count; ++n)
      if (!is_child[n] && mesh_.nodes_[n].parent >= 0) add(name(n) + " has a parent that does not know it");
  }

  void check_edges() {
    const int count = static_cast<int>(mesh_.edges_.size());
    for (int e = 0; e < count; ++e) {
      const auto& edge = mesh_.edges_[e];
      if (edge.child < 0) continue;
      if (edge.child <= e || edge.child + 2 > count) {
        add("edge " + std::to_string(e) + " has children out of range");
        continue;
      }
      const auto &a = mesh_.edges_[edge.child], &b = mesh_.edges_[edge.child + 1];
      const VertexId middle(VertexId::Kind::Edge, e);
      if (a.parent != e || b.parent != e || a.level != edge.level + 1 || b.level != edge.level + 1 || a.from != edge.from || a.to != middle ||
          b.from != middle || b.to != edge.to)
        add("edge " + std::to_string(e) + " is not split into its halves");
    }
    for (int n = 0; n < mesh_.node_count(); ++n)
      for (int s = 0; s < 4; ++s) {
        const HalfEdge h = mesh_.nodes_[n].half[s], next = mesh_.nodes_[n].half[(s + 1) % 4];
        if (h < 0 || h >= 2 * count || next < 0 || next >= 2 * count) {
          add(name(n, s) + " has no edge");
        } else if (mesh_.to(h) != mesh_.from(next)) {
          add(name(n, s) + " does not end where the next one starts");
        } else if (mesh_.edges_[h >> 1].level != mesh_.nodes_[n].level) {
          add(name(n, s) + " has an edge of another level");
        }
      }
  }

  void check_operations() {
    std::vector<int> removed_by(mesh_.node_count(), -1);
    for (int o = 0; o < mesh_.operation_count(); ++o) {
      const auto& op = mesh_.operations_[o];
      const std::string what = "operation " + std::to_string(o);
      for (int n : op.repatch.removed) {
        if (n < 0 || n >= mesh_.node_count()) {
          add(what + " removes a node out of range");
          continue;
        }
        if (mesh_.is_root(n)) add(what + " removes a root quad");
        if (mesh_.level(n) != op.repatch.level) add(what + " removes a quad of another level");
        if (removed_by[n] >= 0) add(name(n) + " is removed by two operations");
        removed_by[n] = o;
      }
      for (int r : op.roots)
        if (r < 0 || r >= mesh_.node_count() || !mesh_.is_root(r) || mesh_.level(r) != op.repatch.level || mesh_.nodes_[r].operation != o)
          add(what + " has a root quad that is not its own");
      for (int d : op.depends) {
        if (d < 0 || d >= o)
          add(what + " depends on one that is not earlier");
        else if (op.enabled && !mesh_.operations_[d].enabled)
          add(what + " is enabled without one that it needs");
      }
    }
    for (int n = 0; n < mesh_.node_count(); ++n)
      if (!mesh_.is_root(n) && mesh_.nodes_[n].operation != removed_by[n]) add(name(n) + " is removed by an operation that does not say so");
  }

  void check_holders() {
    std::vector<int> expected(mesh_.holder_.size(), -1);
    for (int n = 0; n < mesh_.node_count(); ++n) {
      const auto& node = mesh_.nodes_[n];
      bool active = node.parent >= 0 ? mesh_.nodes_[node.parent].active : node.operation < 0 || mesh_.operations_[node.operation].enabled;
      if (active && node.parent >= 0 && node.operation >= 0) active = !mesh_.operations_[node.operation].enabled;
      if (active != node.active) add(name(n) + (active ? " should be active" : " should not be active"));
      if (!active) continue;
      for (int s = 0; s < 4; ++s) {
        int& held = expected[node.half[s]];
        if (held >= 0) add(name(n, s) + " is held by two nodes");
        held = 4 * n + s;
      }
    }
    if (expected != mesh_.holder_) add("the links of half-edges are not up to date");
  }

  void check_neighbours() {
    for (int n = 0; n < mesh_.node_count(); ++n) {
      if (!mesh_.is_active(n)) continue;
      for (int s = 0; s < 4; ++s) {
        const SideLink other = mesh_.neighbour(n, s);
        if (!other.valid()) continue;
        if (mesh_.level(other.node) == mesh_.level(n)) {
          if (mesh_.neighbour(other.node, other.side) != SideLink{n, s}) add(name(n, s) + " has a neighbour that does not know it");
        } else if (mesh_.is_leaf(n)) {
          const auto back = mesh_.leaf_neighbours(other.node, other.side);
          if (std::find(back.begin(), back.end(), SideLink{n, s}) == back.end()) add(name(n, s) + " has a coarser neighbour that does not know it");
        }
      }
    }
  }

  void check_balance() {
    for (int n : mesh_.leaves()) {
      int finer = 0;
      for (int s = 0; s < 4; ++s) {
        finer += mesh_.has_finer_neighbour(n, s);
        for (const SideLink& other : mesh_.leaf_neighbours(n, s))
          if (std::abs(mesh_.level(other.node) - mesh_.level(n)) > 1) add(name(n, s) + " has a leaf of two levels' difference across");
        for (int other : mesh_.leaves_at_corner(n, s))
          if (std::abs(mesh_.level(other) - mesh_.level(n)) > 1) add(name(n) + " touches a leaf of two levels' difference at a corner");
      }
      if (finer > 2) add(name(n) + " has finer neighbours on " + std::to_string(finer) + " sides");
    }
  }

  void check_manifolds() {
    for (int j = 0, last = mesh_.deepest_level(); j <= last; ++j) {
      const std::string defect = mesh_.find_fan_defect(j);
      if (!defect.empty()) add(defect);
    }
  }

  void check_counts() {
    HybridMesh copy = mesh_;
    copy.count_leaves();
    const auto a = mesh_.leaf_counts(), b = copy.leaf_counts();
    if (a.vertices != b.vertices || a.faces != b.faces || a.hanging != b.hanging || a.euler != b.euler)
      add("the counts of the leaves are not up to date");
  }

  void check_maps() {
    for (int n = 0; n < mesh_.node_count(); ++n)
      if (const PatchMap* map = mesh_.map(n)) {
        const std::string defect = find_map_defect(*map);
        if (!defect.empty()) add(name(n) + " has a " + defect);
      }
  }

  const HybridMesh& mesh_;
  std::vector<std::string> defects_;
};

std::vector<std::string> find_defects(const HybridMesh& mesh) { return HierarchyAccess(mesh).find_defects(); }

}  // namespace hybrid_mesh
