// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// A disk that fills a rim, or an annulus between two: triangles whose corners are the rims' points, in their order (those of the second rim after
// those of the first), and then new ones. Each side of a rim has a face that runs along it in the rim's direction; no other edge has both ends on
// one rim, so that the patch joins any simplicial surface.
struct RimPatch {
  std::vector<Vec3> points;  // the new ones
  std::vector<std::array<int, 3>> faces;
};

// The paper's concentric loops, each a step of an edge's length nearer to the middle and with as many points as make well-shaped triangles, then
// relaxed to a membrane: it may be as far from planar as the rim is. Triangles are as large as the rim's edges beside it and grow towards the middle.
// The rim has at least 3 points.
RimPatch cap_loop(const std::vector<Vec3>& rim);

// Rows of triangles from one rim to the other, along whose directions the faces run: the rims go round the annulus in opposite directions.
// At least `least_rows` of them.
RimPatch tube_between(const std::vector<Vec3>& first, const std::vector<Vec3>& second, int least_rows);

}  // namespace hybrid_mesh
