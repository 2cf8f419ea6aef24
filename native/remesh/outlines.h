// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "hierarchy/hybrid_mesh.h"
#include "layout/search/layout_script.h"

namespace hybrid_mesh {

// Where the base domain's nodes and sides lie under the hierarchy's maps. The first nodes of the hierarchy are the base's quads.
LayoutOutline outline_of_base(const HybridMesh& hierarchy, const QuadGraph& base);

using PointMove = std::function<Vec3(const Vec3&)>;
void move_outline(LayoutOutline& outline, const PointMove& move);
void move_outlines(std::vector<LayoutScript::Level>& levels, const PointMove& move);

}  // namespace hybrid_mesh
