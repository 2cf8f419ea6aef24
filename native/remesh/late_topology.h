// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "construction/construction.h"
#include "remesh/budget.h"
#include "remesh/plan.h"

namespace hybrid_mesh {

// What has opened above the base, and what has not.
struct LateTopology {
  std::vector<Plan::Region> regions;                  // in order
  std::vector<std::pair<int, std::string>> unopened;  // events that found no room before the last level, and why
};

// Opens the events of the construction's surface, each on the first level whose quads can show it and have room for it. Levels are made as they are
// needed, up to the last one that the budget has.
LateTopology open_late(Construction& made, const RemeshTask& task, const Budget& budget);

}  // namespace hybrid_mesh
