// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "construction/construction.h"
#include "layout/base/base_domain.h"
#include "layout/operations/edit_candidates.h"
#include "remesh/candidate.h"

namespace hybrid_mesh {

// Quads: one ring around a feature that sticks out, where that costs next to nothing of the budget.
constexpr double kRoomForARing = 4;

// Which operations a remesh does by itself, on one level: even quads where those of a minimal base are too uneven to be refined any further, and skin
// that grows where quads would be stretched.
struct SkinOptions {
  int level = 0;          // above the base; 0: none
  double even_quads = 0;  // above 0: uneven regions are laid out anew, so that the level has about so many quads in all, ...
  double uneven = 0;      // ... where a quad's energy beyond an isometry's is more than this
  int rounds = 0;         // of skin: what sticks out of the first one's quads grows skin in the second
  EditCandidateOptions skin;
};
// Whether a minimal base is to have operations on a finer level.
bool has_finer_operations(const RemeshOptions& options, const BaseDomain& base, const BaseRequest& request);
SkinOptions skin_options(const RemeshTask& task, const Budget& budget, const BaseDomain& base, const BaseRequest& request);

// Does them. `made`: at the base level, with its maps; afterwards at the level of the operations, if there are any. Returns what was done, as a plan
// has it. Throws NoMap where uneven quads are most of the level, and there is no better layout.
std::vector<Plan::Region> grow_skin(Construction& made, const RemeshTask& task, const SkinOptions& options);

}  // namespace hybrid_mesh
