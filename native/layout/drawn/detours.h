// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {

// Per curve: does it run far from the shortest way between its ends that other curves leave it, so that whoever drew it meant it? Far is farther than
// a share of its length, and than `least`. Those that are `fixed` are not asked.
std::vector<char> find_detours(const SurfaceCurves& curves, const std::vector<char>& fixed, double least, const Progress& progress);

}  // namespace hybrid_mesh
