// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A number that tells surfaces apart: of their points' coordinates and their faces, and of values at the points, if there are some.
std::string fingerprint(const TriangleSurface& surface, const std::vector<double>& values = {});

}  // namespace hybrid_mesh
