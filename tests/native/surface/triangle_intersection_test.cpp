// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangle_intersection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "shapes.h"

namespace hybrid_mesh {
namespace {

TEST(TriangleIntersection, IsOfWhatIsBesideSharedCorners) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(0.2, 0.2, -1), e(0.3, 0.2, 1), f(5, 5, 5), g(0.2, 0.3, 1);
  EXPECT_TRUE(triangles_meet({&a, &b, &c}, {&d, &e, &f}));
  EXPECT_FALSE(triangles_meet({&a, &b, &c}, {&a, &e, &f}));
  EXPECT_TRUE(triangles_meet({&a, &b, &c}, {&a, &e, &d}));
  EXPECT_FALSE(triangles_meet({&a, &b, &c}, {&a, &b, &e}));
  EXPECT_FALSE(triangles_meet({&a, &b, &c}, {&e, &f, &g}));
}

// Beyond a common edge, those that lie on each other meet and no others do.
TEST(TriangleIntersection, OfTwoThatShareAnEdgeIsAFold) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), same(0.7, 0.3, 0), across(0.3, -0.7, 0), above(0.3, 0.7, 1e-300);
  EXPECT_TRUE(triangles_meet({&a, &b, &c}, {&b, &a, &same}));
  EXPECT_TRUE(triangles_meet({&c, &a, &b}, {&same, &b, &a}));
  EXPECT_FALSE(triangles_meet({&a, &b, &c}, {&b, &a, &across}));
  EXPECT_FALSE(triangles_meet({&a, &b, &c}, {&b, &a, &above}));
  EXPECT_TRUE(triangles_meet({&a, &b, &c}, {&a, &c, &b}));
  EXPECT_EQ(common_polygon({&a, &b, &c}, {&a, &c, &b}).size(), 3u);
}

TEST(TriangleIntersection, TrianglesWithoutAreaMeetNothing) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0), low(1, 1, -1), high(1, 1, 1), middle(1, 1, 0);
  EXPECT_FALSE(triangles_meet({&a, &b, &c}, {&low, &high, &middle}));
  EXPECT_FALSE(triangles_meet({&low, &high, &middle}, {&a, &b, &c}));
}

std::vector<Vec3> sorted(std::vector<Vec3> points) {
  std::sort(points.begin(), points.end(), [](const Vec3& p, const Vec3& q) { return p.x() < q.x(); });
  return points;
}

TEST(TriangleIntersection, LinesEndWhereASideGoesThrough) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0), d(1, 1, -1), e(1, 1, 1), f(-1, 1, 1);
  const auto line = sorted(common_polygon({&a, &b, &c}, {&d, &e, &f}));
  ASSERT_EQ(line.size(), 2u);
  EXPECT_LT((line[0] - Vec3(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((line[1] - Vec3(1, 1, 0)).norm(), 1e-12);
  // Of one that shares a corner: from there on.
  const auto from_corner = sorted(common_polygon({&a, &b, &c}, {&a, &d, &e}));
  ASSERT_EQ(from_corner.size(), 2u);
  EXPECT_LT(from_corner[0].norm(), 1e-12);
  EXPECT_LT((from_corner[1] - Vec3(1, 1, 0)).norm(), 1e-12);
}

TEST(TriangleIntersection, TrianglesOfOnePlaneHaveAnAreaInCommon) {
  const Vec3 a(0, 0, 1), b(4, 0, 1), c(0, 4, 1), d(1, 1, 1), e(9, 1, 1), f(1, 9, 1);
  const std::vector<Vec3> area = common_polygon({&a, &b, &c}, {&d, &e, &f});
  Vec3 twice = Vec3::Zero();
  for (std::size_t i = 0; i + 1 < area.size(); ++i) twice += (area[i] - area[0]).cross(area[i + 1] - area[0]);
  EXPECT_NEAR(twice.norm() / 2, 2, 1e-12);  // the triangle (1, 1), (3, 1), (1, 3)
}

// What exactness promises: all that meet have something in common, and it lies on both.
TEST(TriangleIntersection, CommonPolygonsLieOnBothTriangles) {
  TestRandom random(5);
  int meeting = 0;
  for (int round = 0; round < 20000; ++round) {
    std::array<Vec3, 6> p;
    // On a lattice: corners on sides, sides that cross, and triangles in one plane come up all the time.
    for (Vec3& x : p) x = Vec3(random.below(4), random.below(4), random.below(3));
    const TriangleCorners s{&p[0], &p[1], &p[2]}, t{&p[3], &p[4], &p[5]};
    ASSERT_EQ(triangles_meet(s, t), triangles_meet(t, s));
    if (!triangles_meet(s, t)) continue;
    ++meeting;
    const std::vector<Vec3> common = common_polygon(s, t);
    ASSERT_FALSE(common.empty());
    for (const Vec3& corner : common)
      for (const TriangleCorners& on : {s, t}) {
        const Vec3 normal = (*on[1] - *on[0]).cross(*on[2] - *on[0]);
        ASSERT_LT(std::abs(normal.dot(corner - *on[0])), 1e-9 * normal.norm());
        for (int k = 0; k < 3; ++k) ASSERT_GE(normal.cross(*on[(k + 1) % 3] - *on[k]).dot(corner - *on[k]), -1e-9 * normal.squaredNorm());
      }
  }
  EXPECT_GT(meeting, 2000);
}

TEST(TriangleIntersection, PolygonsAreClippedByAPlane) {
  const std::vector<Vec3> square{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
  const Vec3 x = Vec3::UnitX();
  EXPECT_EQ(clipped(square, x, -x).size(), 4u);
  EXPECT_TRUE(clipped(square, -x, -x).empty());
  for (const Vec3& p : clipped(square, x, Vec3(1.5, 7, 7))) EXPECT_GE(p.x(), 1.5 - 1e-12);
  EXPECT_EQ(clipped({Vec3(0, 0, 0), Vec3(1, 0, 0)}, x, Vec3(2, 0, 0)).size(), 0u);
  EXPECT_FALSE(clipped({Vec3(0, 0, 0), Vec3(3, 0, 0)}, x, Vec3(2, 0, 0)).empty());
  EXPECT_EQ(clipped({x}, x, x).size(), 1u);
}

}  // namespace
}  // namespace hybrid_mesh
