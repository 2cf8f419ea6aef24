// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/regions/region_surface.h"
#include "parameterization/patch_gluing.h"
#include "surface/placement.h"
#include "topology/surface_series.h"

namespace hybrid_mesh {

// Exchanges a region's part of the surface for the part, with the same rims, on which some events of a series are open as well: caps and tubes are
// taken out, the two sides of a cut are joined, and what a tube has hidden comes back. Along what is joined both sides get the points of either.
// `glued`: the maps that the part was cut out of, whose sources are faces of the series (see OpenedSurface::faces); it gets the faces of the new
// part. `placement` brings the series to where the part is. Throws NoMap if an event is not wholly inside the region.
RegionSurface exchanged(const RegionSurface& part, const SurfaceSeries& series, const std::vector<int>& events, const Placement& placement,
                        GluedMaps& glued);

// The pieces that a surface with the region's rims is made of.
std::vector<RegionPiece> pieces_of(const RegionSurface& surface, const PatchRegion& region);

}  // namespace hybrid_mesh
