// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid Meshes: Multiresolution using Regular and Irregular Refinement, 2002, section 4.1.
#include "subdivision/catmull_clark.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "subdivision/masks.h"
#include "subdivision/mesh_topology.h"
#include "subdivision/vertex_placement.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

std::string level_name(int level) { return "level " + std::to_string(level); }

// Enables the operations that are wanted and have all that they need.
void choose_operations(HybridMesh& hierarchy, std::vector<bool> wanted) {
  if (wanted.size() != static_cast<std::size_t>(hierarchy.operation_count()))
    refuse(std::to_string(wanted.size()) + " choices for " + std::to_string(hierarchy.operation_count()) + " operations");
  for (int o = 0; o < hierarchy.operation_count(); ++o)
    for (const int needed : hierarchy.operation(o).depends)
      if (!wanted[needed]) wanted[o] = false;
  const std::string reason = hierarchy.set_enabled(wanted);
  if (!reason.empty()) refuse("the chosen operations cannot be applied together: " + reason);
}

bool has_operations(const HybridMesh& hierarchy, int level) {
  for (int o = 0; o < hierarchy.operation_count(); ++o)
    if (hierarchy.operation(o).enabled && hierarchy.operation(o).repatch.level == level) return true;
  return false;
}

// N^from of a uniform hierarchy with the positions of `start`. `given` has the hierarchy that `start` is of.
QuadMesh starting_mesh(const HybridMesh& uniform, const HybridMesh& given, const QuadMesh& start, int from) {
  if (start.points.size() != start.vertex.size()) refuse("positions and vertices of the mesh to subdivide differ in number");
  for (std::size_t v = 0; v < start.points.size(); ++v)
    if (!start.points[v].allFinite()) refuse("position " + std::to_string(v) + " of the mesh to subdivide is not finite");
  QuadMesh mesh = uniform.level_mesh(from);
  const VertexIndex find(start.vertex);
  std::vector<char> placed(mesh.vertex_count(), 0);
  std::vector<std::size_t> missing;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const int i = find(mesh.vertex[v]);
    if (i < 0) missing.push_back(v);
    if (i >= 0) mesh.points[v] = start.points[i];
    placed[v] = i >= 0;
  }
  if (missing.empty()) return mesh;
  const QuadMesh level = given.level_mesh(from, LevelKind::N, FaceClosure::Transition);
  const VertexIndex known(level.vertex);
  int lacking = 0;
  for (const std::size_t v : missing) lacking += known(mesh.vertex[v]) >= 0;
  if (lacking > 0)
    refuse("the mesh to subdivide lacks " + std::to_string(lacking) + " of the " + std::to_string(mesh.vertex_count()) + " vertices of " +
           level_name(from));
  place_vertices(MeshTopology(uniform, mesh), OperationVertices::Stored, placed, own_level_mesh(uniform, from).points, mesh);
  return mesh;
}

// M^j from N^{j-1}.
QuadMesh regular_step(const HybridMesh& uniform, const QuadMesh& coarse, const MeshTopology& topology, int level) {
  const QuadTopology& quads = topology.quads;
  const RefinedPoints refined = refine_points(quads, VertexFans(quads), coarse.points);
  const PlaceIndex edge_of(topology.edges), face_of(coarse.node);
  const VertexIndex old(coarse.vertex);
  QuadMesh fine = uniform.level_mesh(level, LevelKind::M);
  for (std::size_t v = 0; v < fine.vertex_count(); ++v) {
    const VertexId id = fine.vertex[v];
    const int i = old(id);
    if (i >= 0)
      fine.points[v] = refined.vertices[i];
    else
      fine.points[v] = id.kind() == VertexId::Kind::Edge ? refined.edges[edge_of(id.index())] : refined.faces[face_of(id.index())];
  }
  return fine;
}

// N^j from M^j.
QuadMesh irregular_step(const HybridMesh& uniform, const QuadMesh& before, int level, OperationVertices where) {
  QuadMesh after = own_level_mesh(uniform, level);
  const std::vector<Vec3> own = after.points;
  const VertexIndex find(before.vertex);
  std::vector<char> placed(after.vertex_count(), 0);
  for (std::size_t v = 0; v < after.vertex_count(); ++v) {
    const int i = find(after.vertex[v]);
    placed[v] = i >= 0;
    if (i >= 0) after.points[v] = before.points[i];
  }
  place_vertices(MeshTopology(uniform, after), where, placed, own, after);
  return after;
}

}  // namespace

std::vector<bool> operations_below(const HybridMesh& hierarchy, int level) {
  std::vector<bool> result = hierarchy.enabled();
  for (int o = 0; o < hierarchy.operation_count(); ++o)
    if (hierarchy.operation(o).repatch.level >= level) result[o] = false;
  return result;
}

void check_quad_count(const HybridMesh& hierarchy, int level) {
  double quads = 0;
  for (const int leaf : hierarchy.leaves()) quads += std::ldexp(1.0, 2 * std::max(0, level - hierarchy.level(leaf)));
  if (quads > static_cast<double>(max_subdivided_quads))
    throw Error(ErrorCode::Unsupported, level_name(level) + " would have " + std::to_string(static_cast<std::int64_t>(quads)) + " quads; at most " +
                                            std::to_string(max_subdivided_quads) + " are made");
}

void refine_all(HybridMesh& hierarchy, int level) {
  check_quad_count(hierarchy, level);
  hierarchy.refine_uniform(level);
}

SubdividedMesh subdivide(const HybridMesh& hierarchy, const QuadMesh& start, int from, int to, const SubdivisionOptions& options,
                         const Progress& progress) {
  if (from < 0 || to < from || to > HybridMesh::max_level)
    refuse("subdivision from " + level_name(from) + " to " + level_name(to) + "; levels run from 0 to " + std::to_string(HybridMesh::max_level));
  if (from > hierarchy.depth()) refuse("there is no level N" + std::to_string(from) + " to subdivide");
  if (from == to && options.last == LevelKind::M)
    refuse("subdivision to the same level gives N" + std::to_string(to) + ", not M" + std::to_string(to));
  SubdividedMesh result{hierarchy, {}, {}};
  HybridMesh& uniform = result.hierarchy;
  if (options.operations) choose_operations(uniform, *options.operations);
  refine_all(uniform, to);
  QuadMesh mesh = starting_mesh(uniform, hierarchy, start, from);
  MeshTopology topology(uniform, mesh);
  apply_rules(options.rules, mesh, topology);
  for (int level = from + 1; level <= to; ++level) {
    // A level takes four times as long as the one before it.
    progress(std::ldexp(1.0, 2 * (level - 1 - to)));
    const Sharpness sharpness = refined_sharpness(uniform, mesh, topology);
    mesh = regular_step(uniform, mesh, topology, level);
    if (has_operations(uniform, level) && (level < to || options.last == LevelKind::N))
      mesh = irregular_step(uniform, mesh, level, options.operation_vertices);
    topology = MeshTopology(uniform, mesh);
    topology.quads.boundary = options.rules.boundary;
    apply_sharpness(sharpness, mesh, topology);
  }
  result.rules = rules_of(mesh, topology);
  result.mesh = std::move(mesh);
  progress(1);
  return result;
}

}  // namespace hybrid_mesh
