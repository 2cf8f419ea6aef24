// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Centre and scale that bring points to a unit bounding-box diagonal around the origin.
struct SurfaceFrame {
  Vec3 centre = Vec3::Zero();
  double diagonal = 1;

  explicit SurfaceFrame(const std::vector<Vec3>& points) {
    if (points.empty()) return;
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    centre = 0.5 * low + 0.5 * high;
    // Scaled before squaring: coordinates may be anything a double holds.
    const Vec3 size = high - low;
    const double largest = size.maxCoeff();
    if (largest > 0) diagonal = largest * (size / largest).norm();
  }

  Vec3 to_unit(const Vec3& p) const { return (p - centre) / diagonal; }
  Vec3 from_unit(const Vec3& p) const { return centre + diagonal * p; }
  TriangleSurface to_unit(TriangleSurface surface) const {
    for (Vec3& p : surface.points) p = to_unit(p);
    return surface;
  }
};

}  // namespace hybrid_mesh
