// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "topology/surface_loops.h"

namespace hybrid_mesh {

// Fills in the kinds: by the winding number, around points of each loop's disk, of the component that the loop is on.
void tell_kinds(const TriangleSurface& surface, std::vector<SurfaceLoop>& loops, const Progress& progress);

}  // namespace hybrid_mesh
