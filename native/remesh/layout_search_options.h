// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/base/base_domain.h"
#include "layout/search/layout_search.h"
#include "remesh/candidate.h"

namespace hybrid_mesh {

// Quads: one ring around a feature that sticks out, where that costs next to nothing of the budget.
constexpr double kRoomForARing = 4;

// Energy of a quad that is stretched so many times in one direction, beyond an isometry's.
double excess_of_stretch(double stretch);

// How the layout is searched: on the base alone, or, with a minimal one, on finer levels too, where skin is grown.
LayoutSearchOptions layout_search_options(const RemeshOptions& options, const Budget& budget, const TopologySummary& topology, const BaseDomain& base,
                                          const BaseRequest& request);

}  // namespace hybrid_mesh
