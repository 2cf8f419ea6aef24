// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hierarchy/hybrid_mesh.h"
#include "layout/search/layout_search.h"

namespace hybrid_mesh {

// A hierarchy that was laid out level by level.
struct LayoutHierarchy {
  HybridMesh mesh;                        // uniform, down to the last level that was edited
  std::vector<std::vector<int>> node_of;  // per level and patch of its layout (after its edits): the node
};

// The hierarchy over a base domain in which the edits of the levels above the base are irregular operations: edits of one level that share patches
// become one. `base`: nodes and neighbours of the base domain's quads; `edits`: a level each, those of the base done already. Throws Error{Internal}
// if the hierarchy refuses an operation.
LayoutHierarchy make_hierarchy(const PatchedSurface& base, const std::vector<LevelEdits>& edits);

}  // namespace hybrid_mesh
