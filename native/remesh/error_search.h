// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "remesh/candidate.h"

namespace hybrid_mesh {

// A uniform mesh of about the fewest vertices that meet the error bound of the options, on `candidate`'s base or one of another size. Its final mesh
// is fitted. `any_base`: bases of other sizes may be tried. Throws Error{InvalidInput} where the bound is out of reach.
Candidate meet_error(const RemeshTask& task, Candidate candidate, bool any_base);

}  // namespace hybrid_mesh
