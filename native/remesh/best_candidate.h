// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/found.h"
#include "remesh/candidate.h"

namespace hybrid_mesh {

// Fits the final mesh and all levels.
Candidate fitted(const RemeshTask& task, Candidate c, bool may_change_base);

// The best of what the options' effort lets be tried, fitted. Nothing where topology that is to open late finds no room; throws Error where no base
// holds a map.
Found<Candidate> best_candidate(const RemeshTask& task);

}  // namespace hybrid_mesh
