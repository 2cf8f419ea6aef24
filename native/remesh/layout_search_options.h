// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/base/base_domain.h"
#include "layout/search/layout_search.h"
#include "remesh/candidate.h"

namespace hybrid_mesh {

// Quads: one ring around a feature that sticks out, where that costs next to nothing of the budget.
constexpr double kRoomForARing = 4;

// Whether a minimal base is to have irregular operations on a finer level.
bool has_finer_operations(const RemeshOptions& options, const BaseDomain& base, const BaseRequest& request);

// How the base's layout is searched.
LayoutSearchOptions layout_search_options(const RemeshOptions& options, const Budget& budget, const BaseDomain& base, const BaseRequest& request);

}  // namespace hybrid_mesh
