// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/progress_steps.h"
#include "topology/surface_loops.h"

namespace hybrid_mesh {

// Fills in the kinds: by the winding number, around points of each loop's disk, of the component that the loop is on.
// The first one tells nobody how far it is, the other one takes two steps a loop.
void tell_kinds(const TriangleSurface& surface, std::vector<SurfaceLoop>& loops, const Progress& progress);
void tell_kinds(const TriangleSurface& surface, std::vector<SurfaceLoop>& loops, ProgressSteps& steps);

}  // namespace hybrid_mesh
