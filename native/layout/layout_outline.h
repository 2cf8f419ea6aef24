// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "parameterization/quad_graph.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// The quads of a layout without the surface that it was made on.
struct LayoutOutline {
  std::vector<Vec3> nodes;                // where they lie in space
  std::vector<std::array<int, 4>> quads;  // nodes, counter-clockwise; side i runs from node i to node i + 1
  std::vector<std::array<PatchSide, 4>>
      neighbours;  // across each side, patch -1: the boundary. Empty: by the nodes at their ends, which no two sides have in common then
  std::vector<std::array<std::vector<Vec3>, 4>>
      sides;  // lines in space along which the sides lay, where known: of several ways around the surface they tell which one is meant. May be empty
};

using PointMove = std::function<Vec3(const Vec3&)>;
void move_outline(LayoutOutline& outline, const PointMove& move);

}  // namespace hybrid_mesh
