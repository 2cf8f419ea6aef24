// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"
#include "hierarchy/irregular_operations.h"

namespace hybrid_mesh {

// Hierarchies made by hand, step by step. A step leaves nodes and vertices with the numbers that they had and positions where they were. What it adds
// is placed on the level where it comes up, and on every finer one by Catmull-Clark subdivision of the level before.

// A hierarchy of one level, N0. Throws Error{InvalidInput} if the quads are no 2-manifold whose points all have quads, or one has a point twice.
HybridMesh make_base(const std::vector<Vec3>& points, const std::vector<std::array<int, 4>>& quads);

// Quads refined until all have at least this level. Throws Error{InvalidInput} for a level out of range; Error{Unsupported} if there would be more
// than max_subdivided_quads.
HybridMesh refine(const HybridMesh& hierarchy, int level, const Progress& progress);

struct ChangedHierarchy {
  HybridMesh hierarchy;
  std::vector<int> roots;  // that the operation made
};

// Applies an operation and puts the vertices that it makes where the draft says. The new quads are refined as far as the others if these are all of
// one level, else until the hierarchy is balanced. Throws Error{InvalidInput} with the reason if there is no such operation, or if the level's
// positions do not tell which way it rises; Error{Unsupported} as refine() does.
ChangedHierarchy change(const HybridMesh& hierarchy, const OperationDraft& draft, const Progress& progress);

}  // namespace hybrid_mesh
