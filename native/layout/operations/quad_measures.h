// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/level_state.h"

namespace hybrid_mesh {

// Of each quad of a level: the energy of its map beyond an isometry's, in quads of mean area; the area of the surface under it.
std::vector<double> quad_energies(const LevelState& state);
std::vector<double> quad_areas(const LevelState& state);
// How many times the mean area the largest quad of a level covers.
double largest_area_ratio(const LevelState& state);

}  // namespace hybrid_mesh
