// SPDX-License-Identifier: GPL-3.0-or-later
// Closed and open surfaces of any genus, made up so that tests need no files.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

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

inline TriangleSurface repaired(const PolygonSoup& soup) {
  Context context;
  RepairReport report;
  return repair(soup, RepairOptions(), report, Progress(context));
}

// A ball with holes, each the faces around a point, with two points between them at least. 8 n^2 faces before that.
inline PolygonSoup ball_with_holes(int n, int& holes) {
  const TriangleSurface whole = repaired(ball(n));
  std::vector<std::set<int>> beside(whole.points.size());
  for (const auto& f : whole.faces)
    for (int i = 0; i < 3; ++i) beside[f[i]].insert({f[(i + 1) % 3], f[(i + 2) % 3]});
  std::vector<char> middle(whole.points.size(), 0);
  holes = 0;
  for (std::size_t v = 0; v < beside.size(); ++v) {
    std::set<int> near{static_cast<int>(v)};
    for (int ring = 0; ring < 4; ++ring)
      for (const int w : std::set<int>(near)) near.insert(beside[w].begin(), beside[w].end());
    if (std::any_of(near.begin(), near.end(), [&](int w) { return middle[w] != 0; })) continue;
    middle[v] = 1;
    ++holes;
  }
  PolygonSoup s;
  s.points = whole.points;
  for (const auto& f : whole.faces) {
    if (middle[f[0]] || middle[f[1]] || middle[f[2]]) continue;
    s.indices.insert(s.indices.end(), f.begin(), f.end());
    s.offsets.push_back(static_cast<std::int64_t>(s.indices.size()));
  }
  return s;
}

// A plate with windows in a row, rounded off: genus `windows`. Its quads are 1 / n wide before it is.
inline PolygonSoup plate_with_windows(int windows, int n) {
  const int width = 2 * windows + 1, height = 3;
  const auto solid = [&](int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= width * n || y >= height * n || z >= n) return false;
    return !(y / n == 1 && (x / n) % 2 == 1);
  };
  PolygonSoup s;
  std::map<std::array<int, 3>, int> number;
  const auto vertex = [&](int x, int y, int z) {
    const auto [it, fresh] = number.insert({{x, y, z}, static_cast<int>(s.points.size())});
    if (fresh) s.points.push_back(Vec3(x, y, z) / n);
    return it->second;
  };
  for (int x = 0; x < width * n; ++x)
    for (int y = 0; y < height * n; ++y)
      for (int z = 0; z < n; ++z)
        for (int axis = 0; solid(x, y, z) && axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> beside{x, y, z};
            beside[axis] += 2 * side - 1;
            if (solid(beside[0], beside[1], beside[2])) continue;
            for (int k = 0; k < 4; ++k) {
              const int turn = side ? k : 3 - k;
              std::array<int, 3> corner{x, y, z};
              corner[axis] += side;
              corner[(axis + 1) % 3] += turn == 1 || turn == 2;
              corner[(axis + 2) % 3] += turn >= 2;
              s.indices.push_back(vertex(corner[0], corner[1], corner[2]));
            }
            s.offsets.push_back(static_cast<std::int64_t>(s.indices.size()));
          }
  for (int round = 0; round < 2 * n; ++round) {
    std::vector<Vec3> sum(s.points.size(), Vec3::Zero());
    std::vector<int> count(s.points.size(), 0);
    for (std::size_t i = 0; i < s.indices.size(); i += 4)
      for (int k = 0; k < 4; ++k) {
        sum[s.indices[i + k]] += s.points[s.indices[i + (k + 1) % 4]];
        ++count[s.indices[i + k]];
      }
    for (std::size_t v = 0; v < sum.size(); ++v) s.points[v] = 0.5 * s.points[v] + 0.5 * sum[v] / count[v];
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

}  // namespace hybrid_mesh::testing
