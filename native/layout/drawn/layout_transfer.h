// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/context.h"
#include "layout/drawn/patch_layout.h"

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

// Of a cut surface: its sides thinned out to a few points each.
LayoutOutline outline_of(const PatchedSurface& surface);

struct TransferredLayout {
  PatchLayout layout;   // its faces are the quads, its first nodes the nodes, both in their order; empty if it failed
  std::string failure;  // why there is no such layout; empty if there is one
};

// Lays quads on another surface of about the same shape: every node goes to the nearest point of it, and geodesics join them, disjoint, so that the
// faces are exactly the quads. Throws Error{InvalidInput} for quads that are none of a surface.
TransferredLayout transfer_layout(const TriangleSurface& surface, const LayoutOutline& outline, const Progress& progress);

}  // namespace hybrid_mesh
