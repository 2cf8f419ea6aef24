// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
#pragma once

#include <array>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Normal and two tangents of a vertex, orthonormal.
using Frame = std::array<Vec3, 3>;

// Of a mesh's vertices, at other points than its own. Additions, products, quotients and roots in an order that the mesh gives: wherever doubles are
// those of IEEE 754 and no two operations are made one, the same bits.
std::vector<Frame> surface_frames(const QuadMesh& mesh, const std::vector<Vec3>& points);

}  // namespace hybrid_mesh
