// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/layout_hierarchy.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace hybrid_mesh {
namespace {

// The edits of one level, gathered to operations on disjoint sets of its quads.
class LevelOperations {
 public:
  LevelOperations(HybridMesh& mesh, PatchedSurface& layout, std::vector<int>& node_of, int level)
      : mesh_(mesh), layout_(layout), node_of_(node_of), level_(level) {
    const int count = layout.patch_count();
    patches_.resize(count);
    std::iota(patches_.begin(), patches_.end(), 0);
    group_ = patches_;
    kinds_.resize(count);
    vertices_.resize(layout.node_count);
    for (int q = 0; q < count; ++q)
      for (int i = 0; i < 4; ++i) vertices_[layout.nodes[q][i]] = {mesh.corner(node_of[q], i), -1};
  }

  void run(const LevelEdits& edits) {
    const int old_count = static_cast<int>(node_of_.size());
    for (const LayoutEdit& edit : edits) change(edit);
    // Quads by group: those of the level that are gone, and those that came.
    std::map<int, Group> groups;
    std::vector<char> left(old_count, 0);
    for (std::size_t q = 0; q < patches_.size(); ++q) {
      if (patches_[q] < old_count)
        left[patches_[q]] = 1;
      else
        groups[find(patches_[q])].added.push_back(static_cast<int>(q));
    }
    for (int q = 0; q < old_count; ++q)
      if (!left[q]) groups[find(q)].removed.push_back(node_of_[q]);
    std::vector<int> nodes(patches_.size(), -1);
    for (std::size_t q = 0; q < patches_.size(); ++q)
      if (patches_[q] < old_count) nodes[q] = node_of_[patches_[q]];
    for (const auto& [name, group] : groups) apply(group, kinds_[name], nodes);
    node_of_ = std::move(nodes);
  }

 private:
  struct Group {
    std::vector<int> removed, added;  // nodes; patches
  };
  // A layout's node: a vertex of the level, or a new one.
  struct Vertex {
    VertexId old;
    int fresh = -1;
  };
  struct Kind {
    int edits = 0;
    bool towers = true;
  };

  int find(int a) {
    while (group_[a] != a) a = group_[a] = group_[group_[a]];
    return a;
  }

  void change(const LayoutEdit& edit) {
    Kind kind{1, edit.rings > 0};
    int group = -1;
    for (const int q : edit.patches) {
      const int g = find(patches_[q]);
      if (group >= 0 && g == group) continue;
      kind.edits += kinds_[g].edits;
      kind.towers &= kinds_[g].towers;
      if (group < 0) {
        group = g;
      } else {
        group_[std::max(g, group)] = std::min(g, group);
        group = std::min(g, group);
      }
    }
    kinds_[group] = kind;
    const LayoutChange change = change_layout(layout_, edit);
    std::vector<int> patches(layout_.patch_count(), -1);
    for (std::size_t q = 0; q < change.patch.size(); ++q)
      if (change.patch[q] >= 0) patches[change.patch[q]] = patches_[q];
    for (const int q : change.added) {
      patches[q] = static_cast<int>(group_.size());
      group_.push_back(group);
      kinds_.emplace_back();
    }
    patches_ = std::move(patches);
    std::vector<Vertex> vertices(layout_.node_count);
    for (std::size_t n = 0; n < change.node.size(); ++n)
      if (change.node[n] >= 0) vertices[change.node[n]] = n < vertices_.size() ? vertices_[n] : Vertex{VertexId(), fresh_++};
    vertices_ = std::move(vertices);
  }

  void apply(const Group& group, const Kind& kind, std::vector<int>& nodes) {
    Repatch repatch;
    repatch.kind = kind.towers ? "add_cubes" : "repatch";
    repatch.level = level_;
    repatch.removed = group.removed;
    std::vector<char> inside(layout_.patch_count(), 0);
    for (const int q : group.added) inside[q] = 1;
    // A vertex of the level stays where a side that is not between two new quads holds it; else the operation has taken it, and made another in its
    // place.
    std::map<int, int> corner_of;  // by layout node
    for (const int q : group.added)
      for (int i = 0; i < 4; ++i) {
        const PatchSide other = layout_.neighbours[q][i];
        if (other.patch >= 0 && inside[other.patch]) continue;
        for (const int n : {layout_.nodes[q][i], layout_.nodes[q][(i + 1) % 4]})
          if (vertices_[n].old.valid() && corner_of.insert({n, static_cast<int>(repatch.boundary.size())}).second)
            repatch.boundary.push_back(vertices_[n].old);
      }
    for (const int q : group.added) {
      std::array<int, 4> quad;
      for (int i = 0; i < 4; ++i) {
        const auto [it, fresh] = corner_of.insert({layout_.nodes[q][i], -1 - repatch.new_vertices});
        if (fresh) ++repatch.new_vertices;
        quad[i] = it->second;
      }
      repatch.quads.push_back(quad);
    }
    const std::string refusal = mesh_.apply(repatch);
    if (!refusal.empty()) throw Error(ErrorCode::Internal, "an operation of level " + std::to_string(level_) + " is refused: " + refusal);
    const std::vector<int>& roots = mesh_.operation(mesh_.operation_count() - 1).roots;
    for (std::size_t k = 0; k < group.added.size(); ++k) nodes[group.added[k]] = roots[k];
  }

  HybridMesh& mesh_;
  PatchedSurface& layout_;
  std::vector<int>& node_of_;
  const int level_;
  std::vector<int> patches_;      // per patch of the layout: its number among all that there ever were on this level
  std::vector<int> group_;        // per number: union-find of what belongs to one operation
  std::vector<Kind> kinds_;       // per number
  std::vector<Vertex> vertices_;  // per node of the layout
  int fresh_ = 0;
};

}  // namespace

LayoutHierarchy make_hierarchy(const PatchedSurface& base, const std::vector<LevelEdits>& edits) {
  PatchedSurface layout;
  layout.nodes = base.nodes;
  layout.neighbours = base.neighbours;
  layout.node_count = base.node_count;
  std::vector<std::array<SideLink, 4>> links(base.patch_count());
  for (int q = 0; q < base.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) links[q][i] = {base.neighbours[q][i].patch, base.neighbours[q][i].side};
  LayoutHierarchy out{HybridMesh::from_base(base.node_count, base.nodes, links), {}};
  std::vector<int> node_of(base.patch_count());
  std::iota(node_of.begin(), node_of.end(), 0);
  out.node_of.push_back(node_of);
  std::size_t last = edits.size();
  while (last > 1 && edits[last - 1].empty()) --last;
  for (std::size_t level = 1; level < last; ++level) {
    out.mesh.refine_uniform(static_cast<int>(level));
    layout = quadrisected(std::move(layout));
    std::vector<int> finer(layout.patch_count());
    for (std::size_t q = 0; q < node_of.size(); ++q)
      for (int k = 0; k < 4; ++k) finer[4 * q + k] = out.mesh.first_child(node_of[q]) + k;
    node_of = std::move(finer);
    LevelOperations(out.mesh, layout, node_of, static_cast<int>(level)).run(edits[level]);
    out.node_of.push_back(node_of);
  }
  return out;
}

}  // namespace hybrid_mesh
