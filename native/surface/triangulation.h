// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// The triangles of a soup, in the order of its polygons; a polygon of n corners gives n - 2 of them.
struct Triangulation {
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<std::int32_t> polygon;  // of each triangle
};

// Quads are split by the diagonal that leaves the flatter pair of triangles (the shorter one if both are equally flat), larger polygons
// by clipping ears in their mean plane and flipping diagonals until no triangle can be made rounder; concave polygons keep their shape.
// `source_face` of a repaired surface counts these triangles.
Triangulation triangulate(const PolygonSoup& soup);

}  // namespace hybrid_mesh
