// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "remesh/candidate.h"

namespace hybrid_mesh {

// Throws Error{InvalidInput} for what does not go together with symmetry.
void check_symmetry(const RemeshOptions& options);

// The half of a source that is to be remeshed and mirrored; none if there is no plane in which the surface is nearly symmetric. The source itself is
// placed anew, so that the plane goes through the origin, and has what the report says of its symmetry. Throws Error{InvalidInput} where the
// surface lies wholly on one side, or where its sides differ too much for an average.
std::optional<Source> half_source(Source& whole, const RemeshOptions& options, const Progress& progress);

// What the half is remeshed with: nothing opens late.
RemeshOptions options_of_half(const RemeshOptions& options);

// A candidate of the whole made of a finished one of its half: joined with its mirror image, with all levels measured against the whole. `task`: of
// the whole; `report`: its part about symmetry, which is told what was done without. Throws NoMap where irregular operations cannot be mirrored.
Candidate mirrored_candidate(const RemeshTask& task, const Source& half, const Candidate& made, nlohmann::ordered_json& report);

}  // namespace hybrid_mesh
