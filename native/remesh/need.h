// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// What sizes of quads a surface needs, beside one another, as meshes of it show: where one is far from it, runs through itself or has inverted quads,
// quads are too large.
class Need {
 public:
  // `placed`: the surface, where meshes are.
  explicit Need(const TriangleSurface& placed) : placed_(placed), size_(placed.points.size(), 1) {}

  // Makes sizes smaller where a mesh that was made with them shows that it is needed. Returns whether it is anywhere.
  bool learn_from(const QuadMesh& mesh, const Progress& progress);
  const std::vector<double>& size() const { return size_; }  // per point, in (0, 1]

 private:
  const TriangleSurface& placed_;
  std::vector<double> size_;
};

}  // namespace hybrid_mesh
