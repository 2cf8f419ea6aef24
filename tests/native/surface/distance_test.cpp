// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/distance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>

#include "base/error.h"
#include "shapes.h"
#include "surface/closest_point.h"
#include "surface/one_sided_hausdorff.h"
#include "surface/triangulation.h"

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
          for (const int v : {j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i})
            soup.indices.push_back(first + v);
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

// Whichever surface it is on, and wherever they stand.
TEST(Distance, NamesTheFarthestPoint) {
  PolygonSoup a = grid(10, 10), b = a;
  b.points[60] += Vec3(0, 0, 2);
  for (Vec3& p : a.points) p = 3 * p + Vec3(100, -50, 7);
  for (Vec3& p : b.points) p = 3 * p + Vec3(100, -50, 7);
  EXPECT_LT((distance(a, b).farthest - b.points[60]).norm(), 1e-9);
  EXPECT_LT((distance(b, a).farthest - b.points[60]).norm(), 1e-9);
  b = a;
  b.points[0] += Vec3(-9, -9, 0);
  EXPECT_LT((distance(a, b).boundary_farthest - b.points[0]).norm(), 1e-9);
  // A point inside a face: the middle of a square of which the other surface is the rim.
  const PolygonSoup square = soup_of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, {{0, 1, 2, 3}});
  const PolygonSoup frame = soup_of({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}},
                                    {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
  const SurfaceDistance d = distance(frame, square);
  EXPECT_NEAR(d.hausdorff * d.diagonal, 1, 0.01);
  EXPECT_LT((d.farthest - Vec3(2, 2, 0)).norm(), 0.02);
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

// The triangles that have an area.
std::vector<std::array<int, 3>> triangles_of(const PolygonSoup& soup) {
  std::vector<std::array<int, 3>> triangles = triangulate(soup).triangles;
  std::erase_if(triangles, [&](const auto& t) {
    const Vec3& a = soup.points[t[0]];
    return !((soup.points[t[1]] - a).cross(soup.points[t[2]] - a).norm() > 0);
  });
  return triangles;
}

// The largest distance of a point of `a` to `b` over n (n + 1) / 2 points in every triangle.
double lattice_distance(const PolygonSoup& a, const PolygonSoup& b, int n) {
  const SurfaceDistanceQuery query(b.points, triangles_of(b));
  double largest = 0;
  for (const auto& t : triangles_of(a))
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        const double u = i / (n - 1.0), v = j / (n - 1.0);
        largest = std::max(largest, query.closest((1 - u - v) * a.points[t[0]] + u * a.points[t[1]] + v * a.points[t[2]]).squared_distance);
      }
  return std::sqrt(largest);
}

double longest_edge(const PolygonSoup& soup) {
  double longest = 0;
  for (const auto& t : triangles_of(soup))
    for (int i = 0; i < 3; ++i) longest = std::max(longest, (soup.points[t[i]] - soup.points[t[(i + 1) % 3]]).norm());
  return longest;
}

// The lid of a deep box is farthest from the open box in the middle of the circle that touches its three sides.
TEST(Distance, FindsWhatIsFarthestInsideATriangle) {
  TestRandom random(5);
  for (int round = 0; round < 20; ++round) {
    std::array<Vec3, 3> rim;
    for (Vec3& p : rim) p = {random.unit(), random.unit() * (round % 4 ? 1 : 0.02), 0};
    const double around = (rim[1] - rim[0]).norm() + (rim[2] - rim[1]).norm() + (rim[0] - rim[2]).norm();
    const double radius = (rim[1] - rim[0]).cross(rim[2] - rim[0]).norm() / around;
    const Vec3 down(0, 0, -1);
    const std::vector<std::vector<int>> walls_and_bottom{{0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}, {3, 5, 4}};
    const PolygonSoup open = soup_of({rim[0], rim[1], rim[2], rim[0] + down, rim[1] + down, rim[2] + down}, walls_and_bottom);
    PolygonSoup closed = open;
    append(closed, soup_of({rim[0], rim[1], rim[2]}, {{0, 1, 2}}));
    for (const SurfaceDistance& d : {distance(closed, open, {.samples = 1, .seed = 1}), distance(open, closed, {.samples = 1, .seed = 1})}) {
      EXPECT_LE(d.hausdorff * d.diagonal, radius * (1 + 1e-9));
      EXPECT_GE(d.hausdorff * d.diagonal, radius / 1.0101);
      EXPECT_GE(d.hausdorff_bound * d.diagonal, radius * (1 - 1e-9));
    }
  }
}

// A sheet that leans from one to another is farthest from both along a line, where none of its corners is.
TEST(Distance, FindsWhatIsFarthestBetweenTwoSheets) {
  PolygonSoup sheets = moved(grid(7, 5), {0, 0, -0.3});
  append(sheets, moved(grid(6, 6), {0, 0, 0.5}));
  PolygonSoup all = sheets;
  append(all, soup_of({{0, 0, -0.3}, {5, 0, 0.5}, {5, 5, 0.5}, {0, 5, -0.3}}, {{0, 1, 2, 3}}));
  const SurfaceDistance d = distance(all, sheets, {.samples = 1, .seed = 1});
  EXPECT_LE(d.hausdorff * d.diagonal, 0.4 * (1 + 1e-9));
  EXPECT_GE(d.hausdorff * d.diagonal, 0.4 / 1.0101);
}

TEST(Distance, HausdorffAgreesWithADenseLattice) {
  std::vector<std::pair<PolygonSoup, PolygonSoup>> pairs;
  pairs.emplace_back(glued_rectangle(24, 12, false, true), glued_rectangle(17, 9, false, true));  // closed
  pairs.emplace_back(glued_rectangle(24, 3, true, false), glued_rectangle(31, 2, true, false));   // one-sided, with a boundary
  pairs.emplace_back(sphere(1, 3), sphere(1, 8));                                                 // of six sheets that only touch
  pairs.emplace_back(cube(), moved(sphere(0.7, 6), {0.5, 0.5, 0.5}));
  for (int seed = 1; seed <= 10; ++seed) pairs.emplace_back(random_soup(seed, 12, 10), random_soup(seed + 100, 12, 10));
  for (const auto& [a, b] : pairs) {
    const int n = 60;
    const double lattice = std::max(lattice_distance(a, b, n), lattice_distance(b, a, n)),
                 width = std::max(longest_edge(a), longest_edge(b)) / (n - 1);
    for (const SurfaceDistance& d : {distance(a, b, {.samples = 10, .seed = 1}), distance(b, a, {.samples = 10, .seed = 1})}) {
      EXPECT_GE(d.hausdorff * d.diagonal, lattice / 1.0101);
      EXPECT_LE(d.hausdorff * d.diagonal, lattice + width);
      EXPECT_GE(d.hausdorff_bound * d.diagonal, lattice);
      EXPECT_LE(d.hausdorff_bound, 1.0101 * d.hausdorff);
    }
  }
}

TEST(Distance, BoundsHoldHoweverFewFacesMayBeSplit) {
  const PolygonSoup a = glued_rectangle(24, 12, false, true), b = glued_rectangle(17, 9, false, true);
  const auto from = triangles_of(a), to = triangles_of(b);
  const SurfaceDistanceQuery query(b.points, to);
  const double lattice = lattice_distance(a, b, 60);
  Context context;
  for (const std::vector<char>& rim : {std::vector<char>(), std::vector<char>(to.size(), 0), std::vector<char>(to.size(), 1)}) {
    double before = 0;
    for (const int splits : {0, 1, 10, 100, 1000, 100000}) {
      HausdorffOptions options;
      options.most_splits = splits;
      const HausdorffBounds bounds = one_sided_hausdorff({a.points, from, {}}, {b.points, to, rim}, query, options, Progress(context));
      EXPECT_GE(bounds.at_most, lattice);
      EXPECT_GE(bounds.reached, before);
      before = bounds.reached;
      if (splits == 100000) {
        EXPECT_LE(bounds.at_most, 1.0101 * bounds.reached);
      }
    }
    EXPECT_GE(before, lattice / 1.0101);
  }
}

// A face covers a hole, or a pit, in the top of a block; its corners lie on the top.
TEST(Distance, FindsWhatLiesOverAHoleOrAPit) {
  TestRandom random(7);
  for (int round = 0; round < 30; ++round) {
    std::vector<Vec3> points{{-3, -3, 0}, {6, -2, 0}, {-2, 6, 0}, {-3, -3, -9}, {6, -2, -9}, {-2, 6, -9}};
    const Vec3 at(0.5 * random.unit(), 0.5 * random.unit(), 0);
    for (int i = 0; i < 3; ++i) points.push_back(at + (0.02 + 0.2 * random.unit()) * points[i]);
    for (int i = 6; i < 9; ++i) points.push_back(at + 1.1 * (points[i] - at) - Vec3(0, 0, 2));  // undercut: the rim stays nearest
    std::vector<std::vector<int>> block{{3, 4, 1, 0}, {4, 5, 2, 1}, {5, 3, 0, 2}, {5, 4, 3}};
    for (int i = 0; i < 3; ++i) block.push_back({i, (i + 1) % 3, 6 + (i + 1) % 3, 6 + i});
    const bool pit = round % 2;
    std::vector<std::vector<int>> bottom{{6, 7, 10, 9}, {7, 8, 11, 10}, {8, 6, 9, 11}, {9, 10, 11}};
    if (pit) block.insert(block.end(), bottom.begin(), bottom.end());
    const PolygonSoup soup = soup_of(points, block);

    const Triangulation triangulation = triangulate(soup);
    std::vector<char> rim;
    for (const int polygon : triangulation.polygon) rim.push_back(!pit && polygon >= 4);
    const SurfaceDistanceQuery query(soup.points, triangulation.triangles);
    const std::vector<Vec3> cover{{-2, -2.5, 0}, {4, -2, 0}, {-1.5, 5, 0}};
    const std::vector<std::array<int, 3>> face{{0, 1, 2}};
    Context context;
    const SurfaceFaces faces{soup.points, triangulation.triangles, rim};
    const HausdorffBounds found = one_sided_hausdorff({cover, face, {}}, faces, query, HausdorffOptions(), Progress(context));
    const double around = (points[7] - points[6]).norm() + (points[8] - points[7]).norm() + (points[6] - points[8]).norm();
    const double radius = (points[7] - points[6]).cross(points[8] - points[6]).norm() / around;
    EXPECT_LE(found.reached, radius * (1 + 1e-9));
    EXPECT_GE(found.reached, radius / 1.0101);
    EXPECT_GE(found.at_most, radius * (1 - 1e-9));
  }
}

// Slivers lie along all of a triangle's boundary but for a gap in one side.
TEST(Distance, FindsWhatIsFarthestInsideABoundaryEdge) {
  const std::array<Vec3, 3> corner{Vec3(0, 0, 0), Vec3(3, 0.2, 1), Vec3(1, 9, 0.5)};
  const Vec3 centre = (corner[0] + corner[1] + corner[2]) / 3;
  for (const double begin : {0.1, 0.437})
    for (const double end : {0.57, 0.9}) {
      PolygonSoup slivers;
      const auto add = [&](int side, double s, double t) {
        const Vec3 &a = corner[side], &b = corner[(side + 1) % 3], p = a + s * (b - a), q = a + t * (b - a);
        append(slivers, soup_of({p, q, (p + q) / 2 + 1e-3 * (centre - (p + q) / 2)}, {{0, 1, 2}}));
      };
      add(0, 0, begin), add(0, end, 1), add(1, 0, 1), add(2, 0, 1);
      const SurfaceDistance d = distance(soup_of({corner[0], corner[1], corner[2]}, {{0, 1, 2}}), slivers, {.samples = 1, .seed = 1});
      const double half_gap = (end - begin) / 2 * (corner[1] - corner[0]).norm();
      EXPECT_LE(d.boundary_hausdorff * d.diagonal, half_gap * (1 + 1e-9));
      EXPECT_GE(d.boundary_hausdorff * d.diagonal, half_gap / 1.0101);
    }
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
