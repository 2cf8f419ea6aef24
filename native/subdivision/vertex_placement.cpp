// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/vertex_placement.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"
#include "subdivision/harmonic_extension.h"

namespace hybrid_mesh {

namespace {

// A map of which every sample is unknown.
PatchMap unknown_map() {
  PatchMap map;
  map.uv = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
  map.positions.assign(4, Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  map.triangles = {{0, 1, 2}, {0, 2, 3}};
  map.source_face = {0, 0};
  map.source = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  return map;
}

// The mesh that extract(hierarchy) takes out of it; not a number where that has no position.
template <class Extract>
QuadMesh own_mesh(const HybridMesh& hierarchy, const Extract& extract) {
  QuadMesh mesh = extract(hierarchy);
  std::vector<int> unmapped;  // roots
  for (const MapLocation& location : mesh.location)
    if (hierarchy.map_owner(location.node) < 0) unmapped.push_back(location.node);
  if (unmapped.empty()) return mesh;
  std::sort(unmapped.begin(), unmapped.end());
  unmapped.erase(std::unique(unmapped.begin(), unmapped.end()), unmapped.end());
  HybridMesh marked = hierarchy;
  const PatchMap unknown = unknown_map();
  for (const int root : unmapped) marked.set_map(root, unknown);
  return extract(marked);
}

}  // namespace

QuadMesh own_level_mesh(const HybridMesh& hierarchy, int level) {
  return own_mesh(hierarchy, [&](const HybridMesh& mesh) { return mesh.level_mesh(level); });
}

QuadMesh own_final_mesh(const HybridMesh& hierarchy) {
  return own_mesh(hierarchy, [](const HybridMesh& mesh) { return mesh.final_mesh(); });
}

void place_vertices(const MeshTopology& topology, OperationVertices where, const std::vector<char>& placed, const std::vector<Vec3>& own,
                    QuadMesh& mesh) {
  const std::size_t count = mesh.vertex_count();
  std::vector<Known> known(count, Known::Yes);
  for (std::size_t v = 0; v < count; ++v)
    if (!placed[v]) known[v] = where == OperationVertices::Harmonic || !own[v].allFinite() ? Known::No : Known::Yes;
  if (where == OperationVertices::Carried) {
    // How far the vertices lie from their own positions, as far as these are known.
    std::vector<Known> moved(count, Known::Absent);
    std::vector<Vec3> way(count, Vec3::Zero());
    for (std::size_t v = 0; v < count; ++v) {
      if (!own[v].allFinite()) continue;
      moved[v] = placed[v] ? Known::Yes : Known::No;
      if (placed[v]) way[v] = mesh.points[v] - own[v];
    }
    extend_harmonically(topology.quads.ends, moved, way);
    for (std::size_t v = 0; v < count; ++v)
      if (moved[v] == Known::No) mesh.points[v] = own[v] + way[v];
  } else {
    for (std::size_t v = 0; v < count; ++v)
      if (!placed[v] && known[v] == Known::Yes) mesh.points[v] = own[v];
  }
  const int without = extend_harmonically(topology.quads.ends, known, mesh.points);
  if (without > 0)
    throw Error(ErrorCode::InvalidInput,
                std::to_string(without) + " vertices of an operation have no position on its level and no neighbours with one");
}

}  // namespace hybrid_mesh
