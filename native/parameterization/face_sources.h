// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parameterization/patch_map.h"

namespace hybrid_mesh {

// Where triangles lie on the faces of another surface, each on one: as PatchMap has it.
struct FaceSources {
  std::vector<int> face;                      // per triangle
  std::vector<std::array<float, 9>> weights;  // per triangle: barycentrics of its corners there, corner by corner

  // Makes sources that name these triangles name what the triangles lie on.
  void trace(FaceSources& named) const;
  void trace(PatchMap& map) const;
  // Where one of them, or a part of one, lies: `part` are the barycentrics of that part's corners in the triangle.
  std::array<float, 9> traced(int triangle, const std::array<double, 9>& part) const;
};

}  // namespace hybrid_mesh
