// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/drawn/layout_transfer.h"
#include "layout/regions/region_layout.h"

namespace hybrid_mesh {

// Where the quads of a region's edit lie: their nodes, and lines of a few points along their sides.
LayoutOutline outline_of(const DrawnEdit& drawn, const PatchRegion& region);

// The same for an edit of which no lines are known: nodes alone, between the rims as evenly as in a spring's equilibrium.
LayoutOutline spread_outline(const RegionSurface& surface, const LayoutEdit& edit);

// The region cut along the sides of an outline's quads; without patches if there is no way to lay them out.
PatchedSurface lay_out_region(const RegionSurface& surface, LayoutOutline outline, const Progress& progress);

// Which rows make an annulus' quads about square, and how they are turned the least.
struct RowsPlace {
  int rows = 1;
  int shift = 0;  // see rows_edit()
};
RowsPlace place_rows(const RegionSurface& surface, const PatchRegion& region);

}  // namespace hybrid_mesh
