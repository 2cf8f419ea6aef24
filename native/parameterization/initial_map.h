// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/context.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// Maps every patch to the unit square by convex combinations (Tutte's theorem: the map is bijective), its sides by arc length. Interior edges that
// join two points of one side are split first, so that `surface` may grow. Returns the corners' (u, v) a face in the chart of its patch. Throws
// NoMap naming the patch if no weights give a map that holds in double precision.
std::vector<std::array<Vec2, 3>> map_patches(PatchedSurface& surface, const Progress& progress);

// The same for some of the patches: `corners` is given for the faces of all others, which keep theirs, and sides shared with them follow theirs.
void map_patches(PatchedSurface& surface, const std::vector<int>& patches, std::vector<std::array<Vec2, 3>>& corners, const Progress& progress);

}  // namespace hybrid_mesh
