// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/completion.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "decoder/forest/vertex_index.h"
#include "subdivision/catmull_clark.h"

namespace hybrid_mesh {

namespace {

constexpr double infinitely_sharp = 10;

std::vector<Crease> creases_of(const QuadMesh& mesh) {
  std::vector<Crease> creases;
  if (mesh.sharp.empty()) return creases;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const std::int64_t begin = mesh.offsets[f], end = mesh.offsets[f + 1];
    for (std::int64_t i = begin; i < end; ++i)
      if (mesh.sharp[i]) creases.push_back({mesh.vertex[mesh.indices[i]], mesh.vertex[mesh.indices[i + 1 < end ? i + 1 : begin]], infinitely_sharp});
  }
  return creases;
}

void put_on_maps(const HybridMesh& complete, QuadMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    if (complete.map_owner(mesh.location[v].node) >= 0) mesh.points[v] = complete.sample(mesh.location[v]).position;
}

// What a hierarchy itself has of its levels.
class OwnLevels {
 public:
  explicit OwnLevels(const HybridMesh& hierarchy)
      : hierarchy_(hierarchy), split_(hierarchy.closure() == FaceClosure::Quads && !hierarchy.conforming()) {}

  int finest() const { return hierarchy_.depth() + split_; }

  // Puts the vertices of those quads that the hierarchy has where it has them. `mesh` is a level of `complete`.
  void put_back(const HybridMesh& complete, int level, QuadMesh& mesh) const {
    const QuadMesh own = level > hierarchy_.depth() ? hierarchy_.final_mesh() : hierarchy_.level_mesh(level);
    const VertexIndex find(own.vertex);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      if (!has(complete, mesh.node[f])) continue;
      mesh.for_corners(f, [&](int v) {
        if (const int i = find(mesh.vertex[v]); i >= 0) mesh.points[v] = own.points[i];
      });
    }
  }

 private:
  bool has(const HybridMesh& complete, int node) const {
    if (node < hierarchy_.node_count()) return true;
    const int parent = complete.parent(node);
    return split_ && parent >= 0 && parent < hierarchy_.node_count() && hierarchy_.is_leaf(parent);
  }

  const HybridMesh& hierarchy_;
  bool split_;
};

}  // namespace

HybridMesh completed(const HybridMesh& hierarchy, UnrefinedQuads unrefined, const Progress& progress) {
  const OwnLevels own(hierarchy);
  const int finest = own.finest();
  HybridMesh result = hierarchy;
  const std::vector<int> leaves = hierarchy.leaves();
  if (std::all_of(leaves.begin(), leaves.end(), [&](int leaf) { return hierarchy.level(leaf) == finest; })) return result;
  check_quad_count(hierarchy, finest);  // Before the work is done.
  QuadMesh mesh = hierarchy.level_mesh(0);
  for (int level = 1; level <= finest; ++level) {
    // A level takes four times as long as the one before it.
    const double begin = level == 1 ? 0 : std::ldexp(1.0, 2 * (level - 1 - finest));
    SubdivisionOptions options;
    options.rules.creases = creases_of(mesh);
    SubdividedMesh step = subdivide(result, mesh, level - 1, level, options, progress.part(begin, std::ldexp(1.0, 2 * (level - finest))));
    if (unrefined == UnrefinedQuads::OnMaps) put_on_maps(step.hierarchy, step.mesh);
    own.put_back(step.hierarchy, level, step.mesh);
    step.hierarchy.set_level_positions(level, step.mesh);
    result = std::move(step.hierarchy);
    mesh = std::move(step.mesh);
  }
  result.set_final_positions(mesh);
  return result;
}

}  // namespace hybrid_mesh
