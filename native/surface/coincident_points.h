// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// For every point the first one at exactly the same position (-0 equals 0).
std::vector<std::int32_t> first_coincident(const std::vector<Vec3>& points);

}  // namespace hybrid_mesh
