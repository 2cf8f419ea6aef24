// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// The corners of a triangle; a corner that two triangles share is known by its address.
using TriangleCorners = std::array<const Vec3*, 3>;

// Do two triangles meet elsewhere than at the corners and edges that they share? Exact; triangles without area meet nothing.
bool triangles_meet(const TriangleCorners& a, const TriangleCorners& b);

// What two triangles that meet have in common, to within rounding, as the corners of a convex polygon in order: one of a point, two of a line, three
// to six of the area that triangles of one plane have in common.
std::vector<Vec3> common_polygon(const TriangleCorners& a, const TriangleCorners& b);

// The part of a convex polygon, of any number of corners, on one side of a plane; empty if there is none.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Vec3& inwards, const Vec3& on_plane);

}  // namespace hybrid_mesh
