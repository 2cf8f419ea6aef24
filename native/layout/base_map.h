// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/base_domain.h"
#include "layout/layout_search.h"

namespace hybrid_mesh {

// The smooth map of a surface to the quads of one level: to the base domain, or to that of a finer level that irregular operations have changed.
struct LevelMap {
  int level = 0;
  PatchedSurface layout;  // nodes and neighbours; its points and faces are those of the charts and name those of the surface. Its sides are of no use
  ChartMesh charts;
};

struct BaseMap {
  std::vector<LevelMap> levels;   // that of the base domain first
  std::vector<LevelEdits> edits;  // see search_layout()
};

// Maps `surface` to `base`, whose layout is improved on the way: found on a coarse version of the surface, and carried back to the surface vertex by vertex.
// Throws Error{Internal} if no bijective map is found that holds in double precision; with options for finer levels sooner than without.
BaseMap map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutSearchOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
