// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "surface/polygon_soup.h"

// A namespace of its own: a test executable has other functions of the same names, that make quad hierarchies (hierarchy/bases.h).
namespace hybrid_mesh::shapes {

inline PolygonSoup soup_of(const std::vector<Vec3>& points, const std::vector<std::vector<int>>& polygons) {
  PolygonSoup soup;
  soup.points = points;
  for (const auto& polygon : polygons) {
    soup.indices.insert(soup.indices.end(), polygon.begin(), polygon.end());
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  return soup;
}

inline void append(PolygonSoup& soup, const PolygonSoup& other) {
  const auto shift = static_cast<std::int32_t>(soup.points.size());
  const auto corners = static_cast<std::int64_t>(soup.indices.size());
  soup.points.insert(soup.points.end(), other.points.begin(), other.points.end());
  for (const std::int32_t v : other.indices) soup.indices.push_back(v + shift);
  for (std::size_t p = 0; p < other.polygon_count(); ++p) soup.offsets.push_back(corners + other.offsets[p + 1]);
}

// The same numbers on every platform.
class TestRandom {
 public:
  explicit TestRandom(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ull;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t state_;
};

// A closed quad cube of six faces, outward oriented, [0, 1]^3 moved by `at`.
inline PolygonSoup cube(const Vec3& at = Vec3::Zero()) {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) points.push_back(at + Vec3(i & 1, i >> 1 & 1, i >> 2 & 1));
  return soup_of(points, {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

inline PolygonSoup tetrahedron(const Vec3& at = Vec3::Zero()) {
  return soup_of({at, at + Vec3(1, 0, 0), at + Vec3(0, 1, 0), at + Vec3(0, 0, 1)}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
}

// A flat grid of m x n unit squares, two triangles each.
inline PolygonSoup grid(int m, int n) {
  PolygonSoup soup;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= m; ++i) soup.points.push_back(Vec3(i, j, 0));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i) {
      const int a = j * (m + 1) + i, b = a + 1, c = a + m + 1, d = c + 1;
      for (const int v : {a, b, d, a, d, c}) soup.indices.push_back(v);
      soup.offsets.push_back(soup.offsets.back() + 3);
      soup.offsets.push_back(soup.offsets.back() + 3);
    }
  return soup;
}

// A rectangle of m x n squares glued to itself: along the first direction always, turned over if `twist`; along the second if `tube`.
// Torus, Klein bottle, cylinder and Moebius strip. Positions are in no relation to the shape but distinct.
inline PolygonSoup glued_rectangle(int m, int n, bool twist, bool tube) {
  PolygonSoup soup;
  const int rows = tube ? n : n + 1;
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < rows; ++j) {
      const double u = 2 * M_PI * i / m, v = 2 * M_PI * j / rows, half = twist ? u / 2 : 0, w = tube ? 1 : 2.0 * j / rows - 1;
      if (tube)
        soup.points.push_back({(3 + std::cos(v)) * std::cos(u), (3 + std::cos(v)) * std::sin(u), std::sin(v) + 0.01 * i});
      else
        soup.points.push_back({(3 + w * std::cos(half)) * std::cos(u), (3 + w * std::cos(half)) * std::sin(u), w * std::sin(half)});
    }
  const auto at = [&](int i, int j) {
    if (i == m) i = 0, j = twist ? (tube ? n - j : rows - 1 - j) : j;
    return i * rows + (tube ? (j + n) % n : j);
  };
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      for (const int v : {a, b, c, a, c, d}) soup.indices.push_back(v);
      soup.offsets.push_back(soup.offsets.back() + 3);
      soup.offsets.push_back(soup.offsets.back() + 3);
    }
  return soup;
}

// Random triangles over a few points of a small lattice: every kind of dirt at once.
inline PolygonSoup random_soup(std::uint64_t seed, int points, int faces) {
  TestRandom random(seed);
  PolygonSoup soup;
  for (int i = 0; i < points; ++i) soup.points.push_back(Vec3(random.below(4), random.below(4), random.below(4)));
  for (int f = 0; f < faces; ++f) {
    const int corners = random.below(8) ? 3 : 3 + random.below(4);
    for (int c = 0; c < corners; ++c) soup.indices.push_back(random.below(points));
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  }
  return soup;
}

}  // namespace hybrid_mesh::shapes

namespace hybrid_mesh {
using namespace shapes;
}  // namespace hybrid_mesh
