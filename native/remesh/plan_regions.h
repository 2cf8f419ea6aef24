// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "construction/construction.h"
#include "remesh/plan.h"
#include "remesh/working_surface.h"

namespace hybrid_mesh {

// The quads that a region names, and how they are to be laid out. Throws Error{InvalidInput} for quads that the level does not have.
RegionRepatch resolved(const Plan::Region& region, const AddressedGraph& level);

// A region of the construction's level by addresses, which stay as they are while other regions are laid out anew.
Plan::Region region_of(const RegionRepatch& repatch, const Construction& made);

// Lays out a plan's regions anew, coarse ones first, those of one level in their order. `made`: at the last level that has operations, all with maps;
// of the surface brought to unit size by `placement`. Throws LayoutError with places in the input's space, Error{InvalidInput} with the place in the
// plan, Error{Unsupported} if no map is found; a region that opens topology is left out then. Returns those that were done, in order.
std::vector<Plan::Region> repatch_regions(Construction& made, const std::vector<Plan::Region>& regions, const Placement& placement,
                                          const Progress& progress);

}  // namespace hybrid_mesh
