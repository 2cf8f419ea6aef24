// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/boundary_tower.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "base/error.h"
#include "generated_surfaces.h"
#include "layouts.h"
#include "parameterization/initial_map.h"
#include "shapes.h"
#include "surface/boundary_loop.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::expect_layout;
using testing::repaired;

PatchedSurface grow(const TriangleSurface& surface, const BoundaryTower& tower) {
  Context context;
  return grow_boundary_tower(surface, tower, Progress(context));
}

TriangleSurface open_ball() { return testing::unit(repaired(ball(16, 0.5))); }

// Points around the open ball's rim, somewhat off it.
std::vector<Vec3> around_rim(const std::vector<double>& turns) {
  std::vector<Vec3> points;
  for (const double t : turns) points.push_back(Vec3(0.4 * std::cos(2 * std::numbers::pi * t), 0.4 * std::sin(2 * std::numbers::pi * t), 0.4));
  return points;
}

// Where the base nodes on the boundary lie, in the order of the first four quads' first sides.
std::vector<Vec3> corners_of(const PatchedSurface& base) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 4; ++k) {
    EXPECT_LT(base.neighbours[k][0].patch, 0);
    corners.push_back(base.mesh.points[base.sides[k][0].front()]);
  }
  return corners;
}

TEST(BoundaryLoop, KnowsWhereAPlaceLies) {
  const TriangleSurface sheet = repaired(grid(6, 3));
  const std::vector<BoundaryLoop> loops = boundary_loops(sheet);
  ASSERT_EQ(loops.size(), 1u);
  const BoundaryLoop& loop = loops[0];
  EXPECT_NEAR(loop.length(), 18, 1e-12);
  for (double s = 0.05; s < 18; s += 0.31) {
    EXPECT_NEAR(loop.nearest(loop.at(s)), s, 1e-9);
    EXPECT_NEAR((loop.at(s + 18) - loop.at(s)).norm(), 0, 1e-9);
  }
  int corners = 0;
  for (int i = 0; i < loop.size(); ++i) corners += loop.turn(i, 0.5) > 1.5;
  EXPECT_EQ(corners, 4);
  EXPECT_TRUE(boundary_loops(repaired(ball(4))).empty());
}

TEST(BoundaryLoop, OfNoLengthIsAPoint) {
  const Vec3 place(3, 1, 2);
  const std::vector<Vec3> points(3, place);
  const BoundaryLoop loop(points, {0, 1, 2});
  EXPECT_EQ(loop.length(), 0);
  for (const double arc : {-1.0, 0.0, 0.5}) EXPECT_EQ(loop.at(arc), place);
  EXPECT_EQ(loop.nearest(Vec3::Zero()), 0);
  EXPECT_EQ(loop.turn(1, 0.1), 0);
}

TEST(BoundaryTower, IsAChainOfCubes) {
  const TriangleSurface surface = open_ball();
  for (const int cubes : {1, 2, 4}) {
    const PatchedSurface base = grow(surface, {around_rim({0.1, 0.3, 0.65, 0.8}), cubes});
    ASSERT_EQ(base.patch_count(), 4 * cubes + 1);
    expect_layout(surface, base);
    for (int r = 0; r < cubes; ++r)
      for (int k = 0; k < 4; ++k) {
        EXPECT_EQ(base.neighbours[4 * r + k][0].patch, r > 0 ? 4 * (r - 1) + k : -1);
        EXPECT_EQ(base.neighbours[4 * r + k][1].patch, 4 * r + (k + 1) % 4);
      }
    for (int k = 0; k < 4; ++k) EXPECT_EQ(base.neighbours[4 * cubes][k].patch, 4 * (cubes - 1) + k);
    PatchedSurface mapped = base;
    Context context;
    EXPECT_NO_THROW(map_patches(mapped, Progress(context)));
  }
}

TEST(BoundaryTower, TakesItsNodesInAnyOrder) {
  const TriangleSurface surface = open_ball();
  const BoundaryLoop loop = boundary_loops(surface).front();
  std::vector<double> turns{0.05, 0.3, 0.6, 0.85};
  std::vector<double> wanted;
  for (const Vec3& p : around_rim(turns)) wanted.push_back(loop.nearest(p));
  std::sort(wanted.begin(), wanted.end());
  do {
    std::vector<double> arcs;
    for (const Vec3& p : corners_of(grow(surface, {around_rim(turns), 1}))) arcs.push_back(loop.nearest(p));
    ASSERT_EQ(arcs.size(), 4u);
    // The loop has the surface on its left, as the quads have.
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(arcs[k], wanted[k], 0.02 * loop.length());
  } while (std::next_permutation(turns.begin(), turns.end()));
}

TEST(BoundaryTower, PlacesItsNodesEvenlyFromTheSharpestTurnOn) {
  const TriangleSurface square = testing::unit(repaired(grid(12, 12)));
  for (const Vec3& p : corners_of(grow(square, {{}, 1})))
    EXPECT_NEAR(std::min(std::abs(p.x()), std::abs(p.y())), 0.5 / std::sqrt(2.0), 1e-9) << p.transpose();
  const TriangleSurface surface = open_ball();
  const BoundaryLoop loop = boundary_loops(surface).front();
  const std::vector<Vec3> corners = corners_of(grow(surface, {}));
  for (int k = 0; k < 4; ++k) {
    double gap = loop.nearest(corners[(k + 1) % 4]) - loop.nearest(corners[k]);
    if (gap < 0) gap += loop.length();
    EXPECT_NEAR(gap, 0.25 * loop.length(), 0.02 * loop.length());
  }
}

// Long and thin, its nodes anywhere: the polygon that it is mapped to crowds them together, and quads drawn there may fold at first.
TEST(BoundaryTower, StandsOnStrips) {
  for (const int length : {16, 23, 30})
    for (int seed = 0; seed < 6; ++seed)
      for (const int cubes : {1, 3}) {
        const TriangleSurface strip = testing::unit(repaired(grid(1, length)));
        const BoundaryLoop loop = boundary_loops(strip).front();
        TestRandom random(seed);
        std::vector<Vec3> nodes;
        for (int k = 0; k < 4; ++k) nodes.push_back(loop.at(random.unit() * loop.length()));
        const PatchedSurface base = grow(strip, {nodes, cubes});
        EXPECT_EQ(base.patch_count(), 4 * cubes + 1);
        expect_layout(strip, base);
      }
}

TEST(BoundaryTower, IsAsHighAsTheSurface) {
  const auto cubes_on = [](double stretch) {
    TriangleSurface surface = repaired(ball(16, 0.5));
    for (Vec3& p : surface.points) p.z() *= stretch;
    return (grow(testing::unit(surface), {}).patch_count() - 1) / 4;
  };
  EXPECT_GE(cubes_on(0.05), 1);
  EXPECT_GT(cubes_on(4), cubes_on(1));
  EXPECT_EQ((grow(testing::unit(repaired(grid(8, 8))), {}).patch_count() - 1) / 4, 1);
}

TEST(BoundaryTower, WhatIsNoDiskIsRefusedInWords) {
  const auto refusal = [](const TriangleSurface& surface, const BoundaryTower& tower) -> std::string {
    try {
      grow(surface, tower);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::InvalidInput);
      return e.what();
    }
    return "";
  };
  PolygonSoup two = ball(6, 0.5);
  testing::add(two, ball(6, 0.5, Vec3(3, 0, 0)));
  PolygonSoup handle = testing::torus(16, 8);
  handle.indices.resize(handle.indices.size() - 4);
  handle.offsets.pop_back();
  EXPECT_NE(refusal(repaired(ball(6)), {}).find("no boundary"), std::string::npos);
  EXPECT_NE(refusal(repaired(two), {}).find("2 components"), std::string::npos);
  EXPECT_NE(refusal(repaired(glued_rectangle(12, 4, false, false)), {}).find("2 boundary loops"), std::string::npos);
  EXPECT_NE(refusal(repaired(handle), {}).find("1 handle"), std::string::npos);
  EXPECT_NE(refusal(open_ball(), {around_rim({0.1, 0.4, 0.7}), 1}).find("not 3"), std::string::npos);
  EXPECT_NE(refusal(open_ball(), {around_rim({0.1, 0.4, 0.7, 0.4}), 1}).find("nodes 1 and 3"), std::string::npos);
}

}  // namespace
}  // namespace hybrid_mesh
