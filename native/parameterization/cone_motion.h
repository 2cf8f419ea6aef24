// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// Moves cones (irregular base nodes) to neighbouring vertices where that lowers the map's energy: only the transition across the edge between the two changes. Where to is read off the disc around
// the cone, flattened by w = z^(4 / k) for k quads and solved by mean-value coordinates with its rim held: the cone belongs where w = 0. Returns how many moved.
int move_cones(ChartMesh& charts, const Distortion& density);

}  // namespace hybrid_mesh
