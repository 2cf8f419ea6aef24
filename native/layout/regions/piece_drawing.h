// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/regions/region_surface.h"

namespace hybrid_mesh {

// Draws an edit's new quads in a region of several pieces, all of them disks or rings between two rims: each piece by itself, as draw_quads() and
// draw_ring() do. `surface` gets further points, and its points and faces are put in another order. Returns it cut along the quads' sides: a patch
// each, its sources name points, its faces faces of `surface`. Throws NoMap where a piece's map degenerates.
PatchedSurface draw_pieces(RegionSurface& surface, const PatchRegion& region, const LayoutEdit& edit);

// Can it do so?
bool has_drawable_pieces(const PatchRegion& region);

}  // namespace hybrid_mesh
