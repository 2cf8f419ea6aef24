// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A number that tells surfaces apart: of their points' coordinates and their faces.
std::string fingerprint(const TriangleSurface& surface);

}  // namespace hybrid_mesh
