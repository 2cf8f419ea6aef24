// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "layout/base/base_domain.h"
#include "layout/search/layout_search.h"
#include "remesh/remesh.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {

// Levels and base size of a mesh with a vertex budget.
struct Budget {
  std::int64_t vertices = 0;
  int levels = 0;
  double base_size = 0;  // see BaseDomainOptions
  double boundary_side = 0;
};

// Quads: one ring around a feature that sticks out, where that costs next to nothing of the budget.
constexpr double kRoomForARing = 4;

// How the layout is searched: on the base alone, or on finer levels too, where skin is grown. attempt: how many bases have failed before.
LayoutSearchOptions layout_search_options(const RemeshOptions& options, const Budget& budget, const TopologySummary& topology, const BaseDomain& base,
                                          int attempt);

}  // namespace hybrid_mesh
