// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that are symmetric in the plane x = 0, as shapes and not triangle by triangle, or nearly so, made up so that tests need no files.
#pragma once

#include <cmath>

#include "generated_surfaces.h"

namespace hybrid_mesh::testing {

// A ball of another radius in each direction, with the triangles of another shape than its own: `radius` of a unit vector.
template <class Radius>
PolygonSoup shaped_ball(int n, double open, const Radius& radius) {
  PolygonSoup s = ball(n, open);
  for (Vec3& p : s.points) {
    p.normalize();
    // The octahedron's edges are not to be in the plane.
    p = Vec3(0.8 * p.x() - 0.6 * p.y(), 0.6 * p.x() + 0.8 * p.y(), p.z());
    p *= radius(p);
  }
  return s;
}

// `bump`: height of a bump on the side of negative x alone.
inline PolygonSoup bumpy_ball(int n, double bump, double open = 2) {
  return shaped_ball(n, open, [&](const Vec3& p) {
    const double on_one_side = bump * std::exp(-((p - Vec3(-0.8, 0.5, 0.33)).squaredNorm()) / 0.1);
    return 1 + 0.15 * std::cos(4 * p.x()) * std::sin(2 * p.y() + 0.5) + 0.1 * std::sin(3 * p.z() + 1) * (1 + p.y()) + on_one_side;
  });
}

// Symmetric in no plane.
inline PolygonSoup lopsided_ball(int n) {
  return shaped_ball(n, 2, [](const Vec3& p) {
    const double a = std::atan2(p.y(), p.x());
    return 1 + 0.3 * std::sin(3 * a + 4 * p.z()) * (1 - p.z() * p.z()) + 0.25 * p.z() * p.x() + 0.2 * p.y() * p.z() * p.x();
  });
}

}  // namespace hybrid_mesh::testing
