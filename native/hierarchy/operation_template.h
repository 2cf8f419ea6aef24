// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// The new quads of an irregular operation, as they can be put in the place of any region with as many sides.
struct OperationTemplate {
  int corners = 0;                        // of the region's boundary
  SideLink start;                         // the removed quad and its side that begins at corner 0
  std::vector<std::array<int, 4>> quads;  // counter-clockwise: 0 .. corners - 1 the region's corners, counter-clockwise, then the new nodes
};

// Nothing for an operation that does not replace a disk by a disk.
std::optional<OperationTemplate> template_of(const HybridMesh& mesh, int operation);

}  // namespace hybrid_mesh
