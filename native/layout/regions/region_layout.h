// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/context.h"
#include "layout/layout_edit.h"
#include "layout/regions/region_surface.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {

// The number of rings that makes a tower's quads about square: the depth of the region, from its boundary to the point farthest from it, over the
// mean length of its boundary sides.
int tower_height(const RegionSurface& surface);

// A new layout for a region and where its sides lie.
struct DrawnEdit {
  LayoutEdit edit;
  PatchedSurface piece;  // the region cut along the new quads' sides
};
// New quads of even size that follow the region's shape, found by decimating it; about `quads`. Nothing if there are none that keep its rims. All
// loops are to be rims.
std::optional<DrawnEdit> even_edit(const QuadGraph& graph, const PatchRegion& region, const RegionSurface& surface, double quads, std::uint64_t seed,
                                   const Progress& progress);

// Applies an edit of a disk: it is mapped to a convex polygon, the new quads are drawn in it with straight sides, and the surface is cut along them.
// The quads' maps are left to map_patches, and `mapped.corners` has entries for all faces. Throws NoMap if the disk's map degenerates.
LayoutChange apply_edit(MappedSurface& mapped, const LayoutEdit& edit);
// The same along given lines, in a region of any topology.
LayoutChange apply_edit(MappedSurface& mapped, DrawnEdit edit);
// The same where `surface`, which has the region's rims, takes the place of the region's own.
LayoutChange apply_edit(MappedSurface& mapped, DrawnEdit edit, RegionSurface surface);

}  // namespace hybrid_mesh
