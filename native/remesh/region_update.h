// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "hierarchy/hybrid_mesh.h"
#include "remesh/plan.h"

namespace hybrid_mesh {

// A hierarchy with one more operation.
struct RegionUpdate {
  HybridMesh hierarchy;
  std::vector<int> root_numbers;  // per node: the number of a root quad in addresses, -1: no root
  int operation = -1;
  // Of the maps of the region's quads and of those smoothed around it: energy beyond an isometry's, in quads of mean size. Where it has not fallen
  // the region is no better than it was.
  double energy_before = 0, energy_after = 0;
  // Of the operation's level and all finer ones.
  struct Level {
    int level = 0;
    std::int64_t vertices = 0, faces = 0;
  };
  std::vector<Level> levels;
};

// Lays out quads of one level of a finished hierarchy anew, as a plan's region says, and rebuilds what lies above them: only they and the rings
// around them get other maps and other places. The new quads are refined as far as those that they replace. Strokes are where the hierarchy is.
// `root_numbers`: as in the result. Throws LayoutError, Error{InvalidInput} for a region that cannot be laid out anew, Error{Unsupported} if no map
// is found.
RegionUpdate repatch_hierarchy(const HybridMesh& hierarchy, const std::vector<int>& root_numbers, const Plan::Region& region,
                               const Progress& progress);

}  // namespace hybrid_mesh
