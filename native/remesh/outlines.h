// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hierarchy/hybrid_mesh.h"
#include "layout/layout_outline.h"

namespace hybrid_mesh {

// Where the base domain's nodes and sides lie under the hierarchy's maps. The first nodes of the hierarchy are the base's quads.
LayoutOutline outline_of_base(const HybridMesh& hierarchy, const QuadGraph& base);

}  // namespace hybrid_mesh
