// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/context.h"
#include "layout/drawn/patch_layout.h"
#include "layout/layout_outline.h"

namespace hybrid_mesh {

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
