// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/context.h"
#include "decoder/transform/subdivision_masks.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Catmull-Clark subdivision over the hierarchy: the regular step N^{j-1} -> M^j gives positions to M^j by the rules of subdivision, as if N^{j-1}
// were a base mesh; the irregular step M^j => N^j keeps them and gives positions to the vertices that its operations make. The rules are defined
// on meshes without hanging nodes, so all quads are refined: an adaptive hierarchy is continued to uniform levels in a copy.

// Sharpness falls by one a level, a fraction of one fades the crease out; 10 and more is infinite. An edge's parts inherit its sharpness. A crease
// whose edge is removed by an operation ends there.
struct Crease {
  VertexId a, b;  // ends of an edge (of all edges between them, if there are several)
  double sharpness = 10;
};
struct SharpVertex {
  VertexId vertex;
  double sharpness = 10;
};

struct CatmullClarkRules {
  BoundaryRule boundary = BoundaryRule::EdgesOnly;
  std::vector<Crease> creases;        // where one is given twice, the last counts
  std::vector<SharpVertex> vertices;  // the same
};

// Where the vertices that operations make are put.
enum class OperationVertices {
  Stored,   // the hierarchy's own position on that level
  Carried,  // the same, moved along: by the harmonic extension of how far subdivision has moved the boundary of the operation from its own position
  Harmonic  // the mean of their neighbours, from the boundary of the operation inwards
};

struct SubdivisionOptions {
  CatmullClarkRules rules;  // on the level where subdivision starts
  // Which operations are applied, one choice for each; those that need a skipped one are skipped too. Not given: those that are enabled.
  std::optional<std::vector<bool>> operations;
  // A vertex whose position the hierarchy does not know (neither kept for the level nor in a map) is Harmonic in any case.
  OperationVertices operation_vertices = OperationVertices::Stored;
  LevelKind last = LevelKind::N;  // M: without the operations of the last level
};

struct SubdividedMesh {
  HybridMesh hierarchy;     // uniform to `mesh`'s level under the chosen operations; what the given one has is named and numbered in it as there
  QuadMesh mesh;            // of `hierarchy`
  CatmullClarkRules rules;  // what is left of the sharpness on mesh's level
};

// Positions on a level from those of N^from in `start`, whose vertices are found by their names. Vertices of N^from that the hierarchy's own level
// does not have, because it is adaptive or has other operations enabled, are filled in from the hierarchy or else harmonically. from <= depth; from
// <= to <= max_level. Throws Error{InvalidInput} if levels are out of range; if `start` lacks a vertex or has a position that is not finite; if a
// crease is no edge of N^from, a sharp vertex is not in it, or a sharpness is negative or no number; if there is no position for an operation's
// vertices, or the chosen operations make no manifold. Throws Error{Unsupported} if there would be more than max_subdivided_quads.
SubdividedMesh subdivide(const HybridMesh& hierarchy, const QuadMesh& start, int from, int to, const SubdivisionOptions& options,
                         const Progress& progress);

inline constexpr std::int64_t max_subdivided_quads = std::int64_t{1} << 23;

// Refines quads until all leaves have at least this level. Throws Error{Unsupported} if there would be more than max_subdivided_quads.
void refine_all(HybridMesh& hierarchy, int level);
// Throws as refine_all() does.
void check_quad_count(const HybridMesh& hierarchy, int level);

// The choice that skips the enabled operations of a level and all finer ones.
std::vector<bool> operations_below(const HybridMesh& hierarchy, int level);

}  // namespace hybrid_mesh
