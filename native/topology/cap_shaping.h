// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "topology/loop_cap.h"

namespace hybrid_mesh {

// Makes the triangles of a disk well-shaped: edges are split, collapsed and flipped, and inner points moved to the middle of those around them.
RimPatch shaped_cap(const std::vector<Vec3>& rim, const RimPatch& cap);

}  // namespace hybrid_mesh
