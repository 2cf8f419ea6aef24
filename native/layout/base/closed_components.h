// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/edit_mesh.h"

namespace hybrid_mesh {

// A closed part of a surface by itself has so many quads at least, those of a cube: fewer would have the same corners, or two sides in common.
inline constexpr int kLeastClosedQuads = 6;

struct ClosedComponents {
  std::vector<int> of;     // per vertex: the closed component that it belongs to, -1 for one with a boundary
  std::vector<int> faces;  // per closed component: how many are alive
};
ClosedComponents closed_components(const EditMesh& mesh);

}  // namespace hybrid_mesh
