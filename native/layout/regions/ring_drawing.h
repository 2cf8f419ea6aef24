// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/regions/region_surface.h"

namespace hybrid_mesh {

// Draws an edit's new quads in a ring: a surface with two boundaries, both of them rims of the region or one of them open. It is cut along a short
// way from corner 0 to the other boundary, the quads along `spoke`, nodes that lead there from node 0, and what comes of it is drawn as a disk is.
// `ring` gets further points. Returns it cut along the quads' sides: a patch each, its sources name points, its faces faces of `ring`. Throws NoMap
// if there is no such way, or the disk's map degenerates.
PatchedSurface draw_ring(RegionSurface& ring, const LayoutEdit& edit, const std::vector<int>& spoke);

// The fewest sides of quads from node 0 to the other boundary, through no third node of a boundary; empty if there is no such way. `corners`: nodes
// before the inner ones, of which the first `first` are on node 0's boundary.
std::vector<int> find_spoke(const std::vector<std::array<int, 4>>& quads, int corners, int first);

}  // namespace hybrid_mesh
