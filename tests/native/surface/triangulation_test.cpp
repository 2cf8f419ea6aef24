// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>

#include "shapes.h"

namespace hybrid_mesh {
namespace {

PolygonSoup polygon(const std::vector<Vec3>& points) {
  PolygonSoup soup;
  soup.points = points;
  for (std::size_t i = 0; i < points.size(); ++i) soup.indices.push_back(static_cast<int>(i));
  soup.offsets.push_back(static_cast<std::int64_t>(points.size()));
  return soup;
}

// Whether the triangles of a flat polygon cover it once: all turn the same way and their areas add up.
void expect_covered(const PolygonSoup& soup, bool allow_no_area = false) {
  const Triangulation t = triangulate(soup);
  ASSERT_EQ(t.triangles.size(), soup.points.size() - 2);
  Vec3 whole = Vec3::Zero();
  for (std::size_t i = 0; i + 1 < soup.points.size(); ++i) whole += (soup.points[i] - soup.points[0]).cross(soup.points[i + 1] - soup.points[0]) / 2;
  double sum = 0;
  for (const auto& f : t.triangles) {
    const Vec3 n = (soup.points[f[1]] - soup.points[f[0]]).cross(soup.points[f[2]] - soup.points[f[0]]) / 2;
    if (allow_no_area)
      EXPECT_GE(n.dot(whole.normalized()), -1e-12);
    else
      EXPECT_GT(n.dot(whole.normalized()), 0);
    sum += n.norm();
  }
  EXPECT_NEAR(sum, whole.norm(), 1e-9 * whole.norm());
}

TEST(Triangulation, QuadsAreSplitInside) {
  // An arrowhead, from each of its corners: only one diagonal lies inside.
  const std::vector<Vec3> arrow{{0, 0, 0}, {2, -2, 0}, {0, 3, 0}, {-2, -2, 0}};
  for (int shift = 0; shift < 4; ++shift) {
    std::vector<Vec3> points;
    for (int i = 0; i < 4; ++i) points.push_back(arrow[(i + shift) % 4]);
    expect_covered(polygon(points));
  }
}

TEST(Triangulation, FlatQuadsAreSplitByTheShorterDiagonal) {
  const Triangulation t = triangulate(polygon({{0, 0, 0}, {4, 0, 0}, {5, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(t.triangles[0], (std::array<std::int32_t, 3>{1, 2, 3}));
}

TEST(Triangulation, BentQuadsAreSplitByTheFlatterPair) {
  const Triangulation t = triangulate(polygon({{0, 0, 0}, {1, 0, 0.5}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(t.polygon, (std::vector<std::int32_t>{0, 0}));
  for (const auto& f : t.triangles) EXPECT_TRUE(std::count(f.begin(), f.end(), 0) && std::count(f.begin(), f.end(), 2));
}

TEST(Triangulation, StarsCombsAndSpirals) {
  for (const int n : {5, 6, 10, 51, 400}) {
    std::vector<Vec3> star, comb, spiral;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * M_PI * i / n, r = i % 2 ? 1 : 0.3;
      star.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
    for (int i = 0; i < n; ++i) comb.push_back({double(i), i % 2 ? 5.0 : 0.1 * (i % 3), 0});
    comb.push_back({double(n), -1, 0}), comb.push_back({-1, -1, 0});
    for (int i = 0; i < n; ++i) spiral.push_back(Vec3(std::cos(0.2 * i), std::sin(0.2 * i), 0) * (1 + 0.1 * i));
    for (int i = n - 1; i >= 0; --i) spiral.push_back(Vec3(std::cos(0.2 * i), std::sin(0.2 * i), 0) * (1.3 + 0.1 * i));
    const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
    for (std::vector<Vec3>* points : {&star, &comb, &spiral}) {
      expect_covered(polygon(*points));
      for (Vec3& p : *points) p = turn * p * 1e-3 + Vec3(5, 6, 7);
      expect_covered(polygon(*points), true);
    }
  }
}

TEST(Triangulation, CornersOnStraightSidesLeaveNoTriangleWithoutArea) {
  // A square with one, two, and three corners more on its sides, as at hanging nodes.
  for (int mask = 1; mask < 16; ++mask)
    for (int shift = 0; shift < 8; ++shift) {
      const std::vector<Vec3> corners{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
      std::vector<Vec3> points;
      for (int i = 0; i < 4; ++i) {
        points.push_back(corners[i]);
        if (mask >> i & 1) points.push_back((corners[i] + corners[(i + 1) % 4]) / 2);
      }
      std::rotate(points.begin(), points.begin() + shift % static_cast<int>(points.size()), points.end());
      expect_covered(polygon(points));
    }
}

TEST(Triangulation, AnyCornersGiveTriangles) {
  TestRandom random(3);
  for (int round = 0; round < 2000; ++round) {
    PolygonSoup soup;
    for (int i = 0; i < 12; ++i) soup.points.push_back(Vec3(random.below(3), random.below(3), random.below(3)));
    const int n = 3 + random.below(12);
    for (int i = 0; i < n; ++i) soup.indices.push_back(random.below(12));
    soup.offsets.push_back(n);
    const Triangulation t = triangulate(soup);
    EXPECT_EQ(t.triangles.size(), static_cast<std::size_t>(n - 2));
    EXPECT_EQ(t.polygon.size(), t.triangles.size());
  }
}

// Polygons of very many corners, convex, jagged and all at one point, must not take quadratic time.
TEST(Triangulation, LargePolygonsAreFast) {
  const auto start = std::chrono::steady_clock::now();
  for (const int kind : {0, 1, 2}) {
    std::vector<Vec3> points;
    TestRandom random(1);
    for (int i = 0; i < 50000; ++i) {
      const double angle = 2 * M_PI * i / 50000, r = kind == 0 ? 1 : kind == 1 ? 0.5 + random.unit() : 0;
      points.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
    EXPECT_EQ(triangulate(polygon(points)).triangles.size(), points.size() - 2);
  }
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20);
}

}  // namespace
}  // namespace hybrid_mesh
