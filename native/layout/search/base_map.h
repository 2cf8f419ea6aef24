// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/found.h"
#include "layout/base/base_domain.h"
#include "layout/search/layout_search.h"

namespace hybrid_mesh {

// The smooth map of a surface to the quads of its base domain.
struct BaseMap {
  // Nodes and neighbours; its points and faces are those of the charts and name those of the surface. None: the charts' are the surface's own. Its
  // sides are of no use.
  PatchedSurface layout;
  ChartMesh charts;
  LayoutScript script;  // how the layout was improved
};

// Maps `surface` to `base`, whose layout is improved on the way: found on a coarse version of the surface, and carried back to the surface vertex by
// vertex.
Found<BaseMap> map_to_base(const TriangleSurface& surface, BaseDomain& base, const LayoutSearchOptions& options, const Progress& progress);
// What a script says instead of a search: with one that came of the same surface and base the same map.
Found<BaseMap> map_to_base(const TriangleSurface& surface, BaseDomain& base, const LayoutScript& script, const Progress& progress);
// On a surface that is cut along its base's sides already, which stay as they are.
Found<BaseMap> map_to_base(const TriangleSurface& surface, PatchedSurface base, const Progress& progress);

}  // namespace hybrid_mesh
