// SPDX-License-Identifier: GPL-3.0-or-later
// Closed and open surfaces of any genus, made up so that tests need no files.
#pragma once

#include <cmath>
#include <numbers>

#include "surface/polygon_soup.h"
#include "surface/repair.h"

namespace hybrid_mesh::testing {

// A torus of n x m quads, bumpy so that no direction is special; radii 1 and r.
inline PolygonSoup torus(int n, int m, double r = 0.4, double bumps = 0.05) {
  PolygonSoup s;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / m;
      const double q = r * (1 + bumps * std::sin(3 * a + 2 * b));
      s.points.push_back(Vec3((1 + q * std::cos(b)) * std::cos(a), (1 + q * std::cos(b)) * std::sin(a), q * std::sin(b)));
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const auto at = [&](int x, int y) { return (x % n) * m + y % m; };
      s.indices.insert(s.indices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      s.offsets.push_back(static_cast<std::int64_t>(s.indices.size()));
    }
  return s;
}

// A ball of triangles (a refined octahedron), dented so that no direction is special; `open` leaves out the faces above that height.
inline PolygonSoup ball(int n, double open = 2, const Vec3& at = Vec3::Zero(), double size = 1) {
  PolygonSoup s;
  const auto place = [&](Vec3 p) {
    p.normalize();
    const double r = 1 + 0.08 * std::sin(4 * p.x() + 1) * std::cos(3 * p.y()) + 0.05 * std::sin(6 * p.z());
    return Vec3(at + size * r * p);
  };
  for (int face = 0; face < 8; ++face) {
    const Vec3 a(face & 1 ? -1 : 1, 0, 0), b(0, face & 2 ? -1 : 1, 0), c(0, 0, face & 4 ? -1 : 1);
    const bool turned = ((face & 1) != 0) ^ ((face & 2) != 0) ^ ((face & 4) != 0);
    // Points repeat along the octahedron's edges; repair merges them, since equal sums give equal doubles.
    const auto point = [&](int i, int j) { return place((a * (n - i - j) + b * i + c * j) / n); };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (int k = 0; k < (i + j + 1 < n ? 2 : 1); ++k) {
          std::array<Vec3, 3> p = k == 0 ? std::array<Vec3, 3>{point(i, j), point(i + 1, j), point(i, j + 1)}
                                         : std::array<Vec3, 3>{point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)};
          if (turned) std::swap(p[1], p[2]);
          if (((p[0] + p[1] + p[2]).z() / 3 - at.z()) / size > open) continue;
          for (const Vec3& x : p) {
            s.indices.push_back(static_cast<std::int32_t>(s.points.size()));
            s.points.push_back(x);
          }
          s.offsets.push_back(static_cast<std::int64_t>(s.indices.size()));
        }
  }
  return s;
}

inline void add(PolygonSoup& to, const PolygonSoup& from) {
  const auto shift = static_cast<std::int32_t>(to.points.size());
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  for (std::size_t p = 0; p < from.polygon_count(); ++p) {
    for (std::int64_t i = from.offsets[p]; i < from.offsets[p + 1]; ++i) to.indices.push_back(from.indices[i] + shift);
    to.offsets.push_back(static_cast<std::int64_t>(to.indices.size()));
  }
}

inline TriangleSurface repaired(const PolygonSoup& soup) {
  Context context;
  RepairReport report;
  return repair(soup, RepairOptions(), report, Progress(context));
}

}  // namespace hybrid_mesh::testing
