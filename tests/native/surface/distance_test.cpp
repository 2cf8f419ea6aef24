// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/distance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>

#include "base/error.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

SurfaceDistance distance(const PolygonSoup& a, const PolygonSoup& b, const DistanceOptions& options = {.samples = 20000, .seed = 1}) {
  Context context;
  const SurfaceDistance d = surface_distance(a, b, options, Progress(context));
  EXPECT_EQ(context.progress(), 1);
  return d;
}

PolygonSoup moved(PolygonSoup soup, const Vec3& by) {
  for (Vec3& p : soup.points) p += by;
  return soup;
}

// A sphere of radius r around the origin, as a polyhedron with its points on the sphere.
PolygonSoup sphere(double r, int n) {
  PolygonSoup soup;
  for (int side = 0; side < 3; ++side)
    for (const int sign : {-1, 1}) {
      const auto first = static_cast<std::int32_t>(soup.points.size());
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          Vec3 p;
          p[side] = sign, p[(side + 1) % 3] = 2.0 * i / n - 1, p[(side + 2) % 3] = 2.0 * j / n - 1;
          soup.points.push_back(p.normalized() * r);
        }
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          for (const int v : {j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i}) soup.indices.push_back(first + v);
          soup.offsets.push_back(soup.offsets.back() + 4);
        }
    }
  return soup;
}

TEST(Distance, OfASurfaceToItselfIsNothing) {
  for (const PolygonSoup& soup : {cube(), grid(5, 5), glued_rectangle(20, 10, false, true)}) {
    const SurfaceDistance d = distance(soup, soup);
    EXPECT_LT(d.hausdorff, 1e-14);
    EXPECT_LT(d.l2, 1e-14);
  }
}

TEST(Distance, OfParallelSquares) {
  const PolygonSoup a = grid(4, 4), b = moved(a, {0, 0, 0.25});
  const SurfaceDistance d = distance(a, b);
  const double relative = 0.25 / (4 * std::sqrt(2.0));
  EXPECT_NEAR(d.diagonal, 4 * std::sqrt(2.0), 1e-12);
  for (const double value : {d.l2, d.l2_ab, d.l2_ba, d.mean, d.hausdorff, d.boundary_hausdorff}) EXPECT_NEAR(value, relative, 1e-12);
}

// Known in closed form: a unit square against one moved by t in its plane.
TEST(Distance, OfASquareMovedInItsPlane) {
  const PolygonSoup a = grid(1, 1), b = moved(a, {0.5, 0, 0});
  const SurfaceDistance d = distance(a, b, {.samples = 200000, .seed = 1});
  EXPECT_NEAR(d.l2 * d.diagonal, std::sqrt(0.125 / 3), 1e-3);
  EXPECT_NEAR(d.mean * d.diagonal, 0.125, 1e-3);
  EXPECT_NEAR(d.hausdorff * d.diagonal, 0.5, 1e-12);
  EXPECT_NEAR(d.boundary_hausdorff * d.diagonal, 0.5, 1e-12);
}

TEST(Distance, OfSpheres) {
  const SurfaceDistance d = distance(sphere(1, 40), sphere(1.1, 40));
  EXPECT_NEAR(d.l2 * d.diagonal, 0.1, 1e-3);
  EXPECT_NEAR(d.hausdorff * d.diagonal, 0.1, 2e-3);
}

TEST(Distance, TakesTheLargerDirection) {
  PolygonSoup a = cube(), b = cube();
  append(b, moved(cube(), {3, 0, 0}));
  const SurfaceDistance d = distance(a, b);
  EXPECT_LT(d.l2_ab, 1e-14);
  EXPECT_GT(d.l2_ba, 1);
  EXPECT_EQ(d.l2, d.l2_ba);
  EXPECT_NEAR(d.hausdorff * d.diagonal, 3, 1e-12);
  EXPECT_EQ(d.boundary_hausdorff, -1);
}

TEST(Distance, SeesASpikeThatNoSampleHits) {
  PolygonSoup a = grid(100, 100), b = a;
  b.points[5050][2] = 1;
  const SurfaceDistance d = distance(a, b, {.samples = 10, .seed = 1});
  EXPECT_NEAR(d.hausdorff * d.diagonal, 1, 1e-12);
}

TEST(Distance, DoesNotDependOnThreads) {
  const PolygonSoup a = glued_rectangle(40, 20, false, true), b = glued_rectangle(30, 17, false, true);
  const SurfaceDistance many = distance(a, b);
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SurfaceDistance single = distance(a, b);
  EXPECT_EQ(many.l2_ab, single.l2_ab);
  EXPECT_EQ(many.l2_ba, single.l2_ba);
  EXPECT_EQ(many.mean, single.mean);
  EXPECT_EQ(many.hausdorff, single.hausdorff);
}

TEST(Distance, SeedsAgreeWithinTheSamplingError) {
  const PolygonSoup a = glued_rectangle(40, 20, false, true), b = glued_rectangle(30, 17, false, true);
  const SurfaceDistance first = distance(a, b, {.samples = 50000, .seed = 1}), second = distance(a, b, {.samples = 50000, .seed = 2});
  EXPECT_NE(first.l2, second.l2);
  EXPECT_NEAR(first.l2, second.l2, 0.01 * first.l2);
}

TEST(Distance, IsRelativeWhereverTheObjectStandsAndHoweverLargeItIs) {
  const PolygonSoup a = glued_rectangle(20, 10, false, true), b = glued_rectangle(16, 11, false, true);
  const SurfaceDistance d = distance(a, b);
  for (const double scale : {1e-300, 1e-3, 1e3, 1e150})
    for (const double shift : {0.0, 1000.0}) {
      PolygonSoup c = a, e = b;
      for (PolygonSoup* s : {&c, &e})
        for (Vec3& p : s->points) p = (p + Vec3(shift, -shift, shift) * 8) * scale;
      const SurfaceDistance other = distance(c, e);
      EXPECT_NEAR(other.l2, d.l2, 1e-4 * d.l2);
      EXPECT_NEAR(other.hausdorff, d.hausdorff, 1e-9);
    }
}

TEST(Distance, RefusesWhatHasNone) {
  const auto code = [](const PolygonSoup& a, const PolygonSoup& b, std::int64_t samples) {
    Context context;
    try {
      surface_distance(a, b, {.samples = samples, .seed = 1}, Progress(context));
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::Internal;
  };
  EXPECT_EQ(code({}, cube(), 10), ErrorCode::InvalidInput);
  EXPECT_EQ(code(cube(), {}, 10), ErrorCode::InvalidInput);
  EXPECT_EQ(code(cube(), cube(), 0), ErrorCode::InvalidInput);
  EXPECT_EQ(code(soup_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), cube(), 10), ErrorCode::InvalidInput);
  EXPECT_EQ(code(soup_of({{1, 1, 1}}, {{0, 0, 0}}), cube(), 10), ErrorCode::InvalidInput);
  EXPECT_EQ(code(soup_of({{0, 0, 0}}, {{0, 1, 2}}), cube(), 10), ErrorCode::InvalidInput);
}

}  // namespace
}  // namespace hybrid_mesh
