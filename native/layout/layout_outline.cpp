// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/layout_outline.h"

namespace hybrid_mesh {

void move_outline(LayoutOutline& outline, const PointMove& move) {
  for (Vec3& p : outline.nodes) p = move(p);
  for (auto& sides : outline.sides)
    for (auto& side : sides)
      for (Vec3& p : side) p = move(p);
}

}  // namespace hybrid_mesh
