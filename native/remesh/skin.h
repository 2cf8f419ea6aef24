// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "construction/construction.h"
#include "layout/base/base_domain.h"
#include "remesh/budget.h"
#include "remesh/plan.h"

namespace hybrid_mesh {

// Grows skin on a fitted base: some levels above it, where that takes little of a uniform mesh's budget, regions with quads that would be stretched
// beyond the options' threshold are laid out anew. `made`: at the base level, with its maps; afterwards at the level of the operations, if there are
// any. Returns what was done, as a plan has it.
std::vector<Plan::Region> grow_skin(Construction& made, const RemeshTask& task, const Budget& budget, const BaseDomain& base);

}  // namespace hybrid_mesh
