// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/coarsening.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

HybridMesh base_of(const HybridMesh& mesh) {
  std::vector<std::array<int, 4>> quads(mesh.base_count());
  std::vector<std::array<SideLink, 4>> links(mesh.base_count());
  for (int q = 0; q < mesh.base_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      quads[q][i] = static_cast<int>(mesh.corner(q, i).index());
      links[q][i] = mesh.root_neighbour(q, i);
    }
  HybridMesh base = HybridMesh::from_base(mesh.base_vertex_count(), quads, links);
  base.take_sharp_sides(mesh);
  return base;
}

class Coarsening {
 public:
  explicit Coarsening(const HybridMesh& old) : old_(old) {}

  Coarsened run() {
    out_.mesh = base_of(old_);
    out_.node.assign(old_.node_count(), -1);
    for (int q = 0; q < old_.base_count(); ++q) out_.node[q] = q;
    for (int i = 0; i < old_.operation_count(); ++i) apply(old_.operation(i));
    for (int n = 0; n < old_.node_count(); ++n)
      if (old_.map(n)) out_.mesh.set_map(take(n), old_.shared_map(n));
    out_.mesh.set_closure(old_.closure());
    out_.vertex.assign(vertex_.begin(), vertex_.end());
    return std::move(out_);
  }

 private:
  int find(int node) {
    int& found = out_.node[node];
    if (found >= 0) return found;
    const int parent = old_.parent(node);
    const int first = out_.mesh.refine(find(parent));
    for (int k = 0; k < 4; ++k) out_.node[old_.first_child(parent) + k] = first + k;
    return found;
  }

  int take(int node) {
    const int found = find(node);
    for (int i = 0; i < 4; ++i) vertex_[old_.corner(node, i)] = out_.mesh.corner(found, i);
    return found;
  }

  void apply(const HybridMesh::Operation& operation) {
    Repatch repatch = operation.repatch;
    for (int& n : repatch.removed) n = take(n);
    for (VertexId& v : repatch.boundary) v = vertex_.at(v);
    repatch.sides.clear();
    std::string refusal = out_.mesh.apply(repatch);
    if (!refusal.empty()) {
      // Beside quads that are coarser two vertices may be joined twice.
      out_.mesh.refine_uniform(repatch.level);
      refusal = out_.mesh.apply(repatch);
    }
    if (!refusal.empty()) throw Error(ErrorCode::Internal, "an operation is refused where it was done before: " + refusal);
    const std::vector<int>& roots = out_.mesh.operation(out_.mesh.operation_count() - 1).roots;
    for (std::size_t k = 0; k < roots.size(); ++k) {
      out_.node[operation.roots[k]] = roots[k];
      take(operation.roots[k]);
    }
  }

  const HybridMesh& old_;
  Coarsened out_;
  std::map<VertexId, VertexId> vertex_;
};

}  // namespace

Coarsened coarsened(const HybridMesh& mesh) { return Coarsening(mesh).run(); }

}  // namespace hybrid_mesh
