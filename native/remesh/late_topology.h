// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "construction/construction.h"
#include "remesh/plan.h"
#include "remesh/source.h"

namespace hybrid_mesh {

// What has opened above the base, and what has not.
struct LateTopology {
  std::vector<Plan::Region> regions;                  // in order
  std::vector<std::pair<int, std::string>> unopened;  // events that found no room before the last level, and why
  std::vector<std::string> waited;                    // per event: why it did not open on the level before, on which it was to
};

struct OpeningBounds {
  std::int64_t vertices = 0;  // that the final mesh may have
  std::int64_t quads = 0;     // of the finest level on which something may open. An adaptive mesh keeps no more of it than what opens there
};
OpeningBounds opening_bounds(const RemeshOptions& options, std::int64_t vertices);

// Opens the events of the construction's surface, each on the first level whose quads can show it and have room for it. Levels are made as they are
// needed, up to the last one within the bounds.
LateTopology open_late(Construction& made, const RemeshTask& task, const OpeningBounds& bounds);

}  // namespace hybrid_mesh
