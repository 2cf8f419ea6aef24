// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Centre and scale that bring a surface to a unit bounding-box diagonal around the origin.
struct Placement {
  Vec3 center = Vec3::Zero();
  double diagonal = 1;
  Vec3 to_unit(const Vec3& p) const { return (p - center) / diagonal; }
  Vec3 from_unit(const Vec3& p) const { return center + diagonal * p; }
  TriangleSurface to_unit(TriangleSurface surface) const {
    for (Vec3& p : surface.points) p = to_unit(p);
    return surface;
  }
};
// A surface where it stands, and what brings it to unit size.
struct PlacedSurface {
  const TriangleSurface* surface = nullptr;  // none: there is no surface
  Placement placement;
};
Placement placement_of(const std::vector<Vec3>& points);

}  // namespace hybrid_mesh
