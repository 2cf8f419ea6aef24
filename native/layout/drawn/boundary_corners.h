// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Points of the boundary where it turns by more than `angle` (radians), measured over a length `window` to both sides so that small jags do not
// count; one for each corner.
std::vector<int> boundary_corners(const TriangleSurface& surface, double window, double angle);

}  // namespace hybrid_mesh
