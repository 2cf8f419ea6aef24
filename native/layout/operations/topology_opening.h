// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/found.h"
#include "layout/operations/region_repatch.h"

namespace hybrid_mesh {

// Per event of a level's surface that is closed, the quads whose maps have its caps or its tube: of a cut on either side, else all first.
using CoveringQuads = std::vector<std::array<std::vector<int>, 2>>;
CoveringQuads covering_quads(const LevelState& state);

// The region of a level in which an event opens, and its layout: for a cut, two disks over its caps, grown until their rims have equally many sides,
// and rows between them; for a boundary, rows from the rim to it; for a tube, the ring that covers it, and two disks. Nothing, and why, where there
// is no room on this level.
// `margin`: rings of quads by which the region is wider at least; a rim through a corner of a cap leaves no room for what opens.
Found<RegionRepatch> find_opening(const LevelState& state, const CoveringQuads& covering, int event, int margin);

}  // namespace hybrid_mesh
