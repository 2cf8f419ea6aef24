// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// Moves cones (irregular base nodes) to neighbouring vertices where that lowers the map's energy: only the transition across the edge between the two
// changes. Where to is read off the disc around the cone, flattened by w = z^(4 / k) for k quads and solved by mean-value coordinates with its rim
// held: the cone belongs where w = 0. `allowed`: per vertex whether it may take a cone (empty: all may). Returns how many moved.
int move_cones(ChartMesh& charts, const Distortion& density, const std::vector<char>& allowed = {});

// Moves one cone to a neighbouring vertex, the one that costs least of those that can take it. Returns that vertex, or -1.
int evict_cone(ChartMesh& charts, const Distortion& density, int cone, const std::vector<char>& allowed = {});

}  // namespace hybrid_mesh
