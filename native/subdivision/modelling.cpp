// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/modelling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/tolerances.h"
#include "subdivision/catmull_clark.h"
#include "subdivision/harmonic_extension.h"
#include "subdivision/mesh_topology.h"
#include "subdivision/vertex_placement.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

bool is_known(const Vec3& point) { return point.allFinite(); }

// Some vertices with their positions, as the setters of positions take them.
struct PlacedVertices {
  QuadMesh mesh;
  void add(VertexId vertex, const Vec3& point) {
    mesh.vertex.push_back(vertex);
    mesh.points.push_back(point);
  }
};

// Positions of a level's vertices by their names.
class LevelPoints {
 public:
  LevelPoints(const HybridMesh& hierarchy, int level) : mesh_(own_level_mesh(hierarchy, level)), find_(mesh_.vertex) {}

  const Vec3& operator()(VertexId vertex) const {
    const int i = find_(vertex);
    if (i < 0 || !is_known(mesh_.points[i])) refuse("the quads have no positions on their level");
    return mesh_.points[i];
  }

 private:
  QuadMesh mesh_;
  VertexIndex find_;
};

// A step of one mean side length along the normal of some quads.
Vec3 rise_of(const HybridMesh& hierarchy, const std::vector<int>& nodes, const LevelPoints& points) {
  Vec3 area = Vec3::Zero();
  double total = 0, length = 0;
  for (const int n : nodes) {
    std::array<Vec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = points(hierarchy.corner(n, i));
    const Vec3 quad = (p[2] - p[0]).cross(p[3] - p[1]);
    area += quad;
    total += quad.norm();
    for (int i = 0; i < 4; ++i) length += (p[(i + 1) % 4] - p[i]).norm();
  }
  if (!(area.norm() > tolerance::cancelled_normals * total)) refuse("the quads face in no direction: their normals cancel each other out");
  return area.normalized() * (length / (4.0 * static_cast<double>(nodes.size())));
}

// Means of neighbours among the vertices of an operation, from its boundary inwards.
std::vector<Vec3> harmonic_points(const Repatch& repatch, const LevelPoints& points) {
  const int outer = static_cast<int>(repatch.boundary.size()), count = outer + repatch.new_vertices;
  std::set<std::array<int, 2>> edges;
  for (const auto& quad : repatch.quads)
    for (int s = 0; s < 4; ++s) {
      const auto place = [&](int c) { return c >= 0 ? c : outer - 1 - c; };
      const auto [a, b] = std::minmax({place(quad[s]), place(quad[(s + 1) % 4])});
      edges.insert({a, b});
    }
  std::vector<Known> known(count, Known::No);
  std::vector<Vec3> values(count, Vec3::Zero());
  for (int k = 0; k < outer; ++k) {
    known[k] = Known::Yes;
    values[k] = points(repatch.boundary[k]);
  }
  if (extend_harmonically({edges.begin(), edges.end()}, known, values) > 0) refuse("the layout has vertices that no edges join to its boundary");
  return {values.begin() + outer, values.end()};
}

// On the operation's own level.
PlacedVertices new_vertices(const HybridMesh& before, const OperationDraft& draft, int first_vertex) {
  const Repatch& repatch = draft.repatch;
  PlacedVertices placed;
  if (repatch.new_vertices == 0) return placed;
  const LevelPoints points(before, repatch.level);
  std::vector<Vec3> positions;
  if (draft.places.empty()) {
    positions = harmonic_points(repatch, points);
  } else {
    const bool rises = std::any_of(draft.places.begin(), draft.places.end(), [](const VertexPlace& place) { return place.rise != 0; });
    const Vec3 rise = rises ? rise_of(before, repatch.removed, points) : Vec3::Zero();
    for (const VertexPlace& place : draft.places) {
      Vec3& position = positions.emplace_back(place.rise * rise);
      for (const auto& [vertex, weight] : place.mean) position += weight * points(vertex);
    }
  }
  for (int v = 0; v < repatch.new_vertices; ++v) placed.add(VertexId(VertexId::Kind::Free, first_vertex + v), positions[v]);
  return placed;
}

// Positions of a level for vertices that have none, by subdivision of the level before.
void place_by_subdivision(HybridMesh& hierarchy, int level, const Progress& progress) {
  QuadMesh mesh = own_level_mesh(hierarchy, level);
  std::vector<std::size_t> missing, closing;  // the latter come of the closure of what is one level coarser
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    if (!is_known(mesh.points[v])) (hierarchy.birth_level(mesh.vertex[v]) <= level ? missing : closing).push_back(v);
  if (!missing.empty()) {
    const QuadMesh subdivided = subdivide(hierarchy, hierarchy.level_mesh(level - 1), level - 1, level, {}, progress).mesh;
    const VertexIndex find(subdivided.vertex);
    for (const std::size_t v : missing) mesh.points[v] = subdivided.points[find(mesh.vertex[v])];
  }
  const VertexIndex find(mesh.vertex);
  for (const std::size_t v : closing) {
    const VertexId vertex = mesh.vertex[v];
    const auto point = [&](VertexId corner) { return mesh.points[find(corner)]; };
    if (vertex.kind() == VertexId::Kind::Edge) {
      mesh.points[v] = (point(hierarchy.from(2 * vertex.index())) + point(hierarchy.to(2 * vertex.index()))) / 2;
    } else {
      mesh.points[v].setZero();
      for (int i = 0; i < 4; ++i) mesh.points[v] += point(hierarchy.corner(vertex.index(), i)) / 4;
    }
  }
  missing.insert(missing.end(), closing.begin(), closing.end());
  PlacedVertices placed;
  for (const std::size_t v : missing) placed.add(mesh.vertex[v], mesh.points[v]);
  if (!missing.empty()) hierarchy.set_level_positions(level, placed.mesh);
}

// The same for a level, all finer ones, and the final mesh, which is the finest.
void place_from_level(HybridMesh& hierarchy, int first, const Progress& progress) {
  const int depth = hierarchy.depth();
  for (int level = first; level <= depth; ++level) {
    // A level takes four times as long as the one before it.
    place_by_subdivision(hierarchy, level, progress.part(std::ldexp(1.0, 2 * (level - 1 - depth)), std::ldexp(1.0, 2 * (level - depth))));
  }
  const QuadMesh own = own_final_mesh(hierarchy), finest = hierarchy.level_mesh(depth);
  PlacedVertices placed;
  for (std::size_t v = 0; v < own.vertex_count(); ++v)
    if (!is_known(own.points[v])) placed.add(finest.vertex[v], finest.points[v]);
  if (!placed.mesh.points.empty()) hierarchy.set_final_positions(placed.mesh);
  progress(1);
}

// Whether all leaves are of one level.
bool is_uniform(const HybridMesh& hierarchy) {
  const int depth = hierarchy.depth();
  const std::vector<int> leaves = hierarchy.leaves();
  return std::all_of(leaves.begin(), leaves.end(), [&](int leaf) { return hierarchy.level(leaf) == depth; });
}

}  // namespace

HybridMesh make_base(const std::vector<Vec3>& points, const std::vector<std::array<int, 4>>& quads) {
  for (std::size_t q = 0; q < quads.size(); ++q)
    if (std::set<int>(quads[q].begin(), quads[q].end()).size() < 4) refuse("quad " + std::to_string(q) + " has the same point twice");
  HybridMesh hierarchy = HybridMesh::from_base(static_cast<int>(points.size()), quads);
  PlacedVertices placed;
  for (std::size_t v = 0; v < points.size(); ++v) placed.add(VertexId(VertexId::Kind::Free, static_cast<int>(v)), points[v]);
  hierarchy.set_level_positions(0, placed.mesh);
  hierarchy.set_final_positions(placed.mesh);
  return hierarchy;
}

HybridMesh refine(const HybridMesh& hierarchy, int level, const Progress& progress) {
  if (level < 0 || level > HybridMesh::max_level)
    refuse("levels run from 0 to " + std::to_string(HybridMesh::max_level) + ": there is no level " + std::to_string(level));
  HybridMesh refined = hierarchy;
  refine_all(refined, level);
  place_from_level(refined, 1, progress);
  if (refined.depth() > hierarchy.depth()) refined.set_final_positions(refined.level_mesh(refined.depth()));
  return refined;
}

ChangedHierarchy change(const HybridMesh& hierarchy, const OperationDraft& draft, const Progress& progress) {
  if (!draft.reason.empty()) refuse(draft.reason);
  ChangedHierarchy changed{hierarchy, {}};
  HybridMesh& mesh = changed.hierarchy;
  const std::string reason = mesh.apply(draft.repatch);
  if (!reason.empty()) refuse(reason);
  const HybridMesh::Operation& operation = mesh.operation(mesh.operation_count() - 1);
  changed.roots = operation.roots;
  const PlacedVertices placed = new_vertices(hierarchy, draft, operation.first_vertex);
  if (!placed.mesh.points.empty()) mesh.set_level_positions(draft.repatch.level, placed.mesh);
  if (is_uniform(hierarchy))
    refine_all(mesh, hierarchy.depth());
  else
    mesh.balance();
  place_from_level(mesh, draft.repatch.level, progress);
  return changed;
}

}  // namespace hybrid_mesh
