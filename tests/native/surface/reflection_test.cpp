// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/reflection.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "symmetric_shapes.h"

namespace hybrid_mesh {
namespace {

using testing::bumpy_ball;

ReflectionSearch search(const TriangleSurface& surface) {
  Context context;
  return find_reflection(surface, Progress(context));
}

TEST(Reflection, IsExactAcrossAnAxisThroughTheOrigin) {
  for (const double sign : {1.0, -1.0})
    for (int axis = 0; axis < 3; ++axis) {
      const MirrorPlane plane{sign * Vec3::Unit(axis), 0};
      const Vec3 p(0.1, -0.7, 1.0 / 3);
      Vec3 mirrored = p, onto = p;
      mirrored[axis] = -p[axis];
      onto[axis] = 0;
      EXPECT_EQ(plane.axis(), axis);
      EXPECT_EQ(plane.reflected(p), mirrored);
      EXPECT_EQ(plane.onto(p), onto);
      EXPECT_FALSE(std::signbit(plane.onto(p)[axis]));
    }
  EXPECT_EQ((MirrorPlane{Vec3(0, -1, 0), 2}).onto(Vec3(1, 1, 1)), Vec3(1, -2, 1));
}

TEST(Reflection, InAnyPlaneKeepsDistancesAndGoesBack) {
  const MirrorPlane plane{Vec3(1, -2, 3).normalized(), 0.4};
  const Vec3 p(0.3, 0.2, -1.1), q = plane.reflected(p);
  EXPECT_EQ(plane.axis(), -1);
  EXPECT_NEAR(plane.height(q), -plane.height(p), 1e-15);
  EXPECT_NEAR((plane.reflected(q) - p).norm(), 0, 1e-15);
  EXPECT_NEAR((plane.onto(p) - 0.5 * (p + q)).norm(), 0, 1e-15);
}

TEST(Reflection, IsFoundWhereverTheSurfaceStandsAndHoweverItIsTurned) {
  const TriangleSurface ball = testing::repaired(bumpy_ball(24, 0));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (const bool turned : {false, true})
    for (const double size : {1.0, 1e-3, 1e4}) {
      TriangleSurface moved = ball;
      for (Vec3& p : moved.points) p = size * ((turned ? Vec3(turn * p) : p) + Vec3(3, 0, -1));
      const ReflectionSearch found = search(moved);
      ASSERT_TRUE(found.plane);
      const Vec3 normal = turned ? Vec3(turn.col(0)) : Vec3(Vec3::UnitX());
      EXPECT_GT(std::abs(found.plane->normal.dot(normal)), 1 - 1e-6);
      EXPECT_NEAR(found.plane->height(size * Vec3(3, 0, -1)), 0, 3e-3 * size);  // the ball's middle
      EXPECT_LT(found.asymmetry.rms, 2e-3);
    }
}

TEST(Reflection, ThroughTheOriginIsMeantExactly) {
  const ReflectionSearch found = search(testing::repaired(bumpy_ball(24, 0)));
  ASSERT_TRUE(found.plane);
  EXPECT_EQ(found.plane->normal, Vec3(1, 0, 0));
  EXPECT_EQ(found.plane->offset, 0);
  EXPECT_LT(found.asymmetry.rms, 1e-3);
}

TEST(Reflection, OfASurfaceThatIsNotSymmetricIsNotFound) {
  const ReflectionSearch found = search(testing::repaired(testing::lopsided_ball(24)));
  EXPECT_FALSE(found.plane);
  EXPECT_GT(found.asymmetry.rms, 0.01);
}

TEST(Reflection, AsymmetryIsThatOfTheShape) {
  Context context;
  const auto of = [&](double bump) { return asymmetry(testing::repaired(bumpy_ball(24, bump)), {Vec3::UnitX(), 0}, Progress(context)); };
  EXPECT_LT(of(0).largest, 3e-3);
  const Asymmetry a = of(0.1);
  EXPECT_GT(a.largest, 0.015);
  EXPECT_LT(a.largest, 0.06);
  EXPECT_LT(a.rms, a.largest);
}

}  // namespace
}  // namespace hybrid_mesh
