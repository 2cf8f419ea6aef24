// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "layout/search/layout_levels.h"

namespace hybrid_mesh {

// Does what a search did on another surface or the same; on the same, with the same result. Throws NoMap where a map cannot be found or
// carried to the surface and where the layout has no such quads.
MappedLayouts replay_layout(CarriedMap map, const LayoutScript& script, const Progress& progress);

}  // namespace hybrid_mesh
