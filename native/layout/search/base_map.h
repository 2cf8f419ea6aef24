// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/found.h"
#include "layout/base/base_domain.h"
#include "layout/search/layout_search.h"

namespace hybrid_mesh {

// The smooth map of a surface to the quads of one level: to the base domain, or to that of a finer level that irregular operations have changed.
struct LevelMap {
  int level = 0;
  PatchedSurface layout;  // nodes and neighbours; its points and faces are those of the charts and name those of the surface. Its sides are of no use
  ChartMesh charts;
};

struct BaseMap {
  std::vector<LevelMap> levels;  // that of the base domain first
  LayoutScript script;
};

// Maps `surface` to `base`, whose layout is improved on the way: found on a coarse version of the surface, and carried back to the surface vertex by
// vertex. With options for finer levels there is no map sooner than without.
Found<BaseMap> map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutSearchOptions& options, const Progress& progress);
// What a script says instead of a search: with one that came of the same surface and base the same map.
Found<BaseMap> map_to_base(const TriangleSurface& surface, const BaseDomain& base, const LayoutScript& script, const Progress& progress);
// The same on a surface that is cut along its base's sides already. No map either if the layout has no such quads as the script names.
Found<BaseMap> map_to_base(const TriangleSurface& surface, PatchedSurface base, const LayoutScript& script, const Progress& progress);

}  // namespace hybrid_mesh
