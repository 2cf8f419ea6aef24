// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// A base domain of a disk: a quad whose corners lie on the boundary, and a chain of cubes grown on it.
struct BoundaryTower {
  std::vector<Vec3> nodes;  // where the corners lie: four points near the boundary, in any order. Empty: at equal distances along it, the first one
                            // where it turns most sharply
  int cubes = 0;            // 0: as many as make their sides about square, at least one; see tower_height()
};

// Cuts a disk along the sides of such a base domain. Of its 4 n + 1 quads, quad 4 r + k lies on side k of the r-th ring, counted from the boundary
// on, its first side towards that; the last one is the top. Throws Error{InvalidInput} for a surface that is no disk, and for nodes that lie at one
// place of its boundary, NoMap if no map is found.
PatchedSurface grow_boundary_tower(const TriangleSurface& surface, const BoundaryTower& tower, const Progress& progress);

}  // namespace hybrid_mesh
