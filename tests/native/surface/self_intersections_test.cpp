// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/self_intersections.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "generated_surfaces.h"
#include "shapes.h"
#include "surface/topology_summary.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {
namespace {

std::vector<SelfIntersection> found_in(const PolygonSoup& soup) {
  Context context;
  std::vector<SelfIntersection> found = find_self_intersections(soup.points, triangulate(soup).triangles, Progress(context));
  EXPECT_EQ(context.progress(), 1);
  return found;
}

PolygonSoup with_shared_points(const PolygonSoup& soup) { return to_soup(testing::repaired(soup)); }

TEST(SelfIntersections, NeighboursThatTouchAreNone) {
  for (const PolygonSoup& soup : {PolygonSoup(), grid(9, 7), cube(), tetrahedron(), with_shared_points(testing::ball(20)), testing::torus(40, 20),
                                  glued_rectangle(30, 10, false, false)})
    EXPECT_TRUE(found_in(soup).empty());
}

TEST(SelfIntersections, OfTwoBallsAreAlongTheLineWhereTheyMeet) {
  const PolygonSoup first = with_shared_points(testing::ball(12)), second = with_shared_points(testing::ball(12, 2, Vec3(1.2, 0.1, 0.05)));
  PolygonSoup both = first;
  append(both, second);
  const auto faces = static_cast<int>(first.polygon_count());
  const std::vector<SelfIntersection> found = found_in(both);
  EXPECT_GT(found.size(), 40u);
  for (const SelfIntersection& s : found) {
    EXPECT_LT(s.faces[0], faces);
    EXPECT_GE(s.faces[1], faces);
    for (const Vec3& end : s.common) {
      EXPECT_NEAR(end.norm(), 1, 0.16);  // dents and all
      EXPECT_NEAR((end - Vec3(1.2, 0.1, 0.05)).norm(), 1, 0.16);
    }
  }
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.faces < b.faces; }));
}

// A sheet of which one point is pushed through another sheet.
TEST(SelfIntersections, AreAsManyAsWereMade) {
  PolygonSoup soup = grid(6, 6);
  PolygonSoup above = grid(1, 1);
  for (Vec3& p : above.points) p = 100 * p + Vec3(-47, -48, 0.5);
  append(soup, above);
  EXPECT_TRUE(found_in(soup).empty());
  soup.points[24].z() = 1;  // an inner point of six triangles
  const std::vector<SelfIntersection> found = found_in(soup);
  EXPECT_EQ(found.size(), 6u);
  for (const SelfIntersection& s : found) {
    EXPECT_GE(s.faces[1], 72);
    for (const Vec3& end : s.common) {
      EXPECT_NEAR(end.z(), 0.5, 1e-12);
      EXPECT_LE((end - soup.points[24]).head<2>().norm(), 0.75);
    }
  }
}

TEST(SelfIntersections, AreTheSameWhateverTheThreads) {
  PolygonSoup soup = with_shared_points(testing::ball(30));
  append(soup, with_shared_points(testing::ball(30, 2, Vec3(0.9, 0, 0))));
  const auto many = found_in(soup);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = found_in(soup);
  ASSERT_EQ(many.size(), single.size());
  for (std::size_t i = 0; i < many.size(); ++i) {
    EXPECT_EQ(many[i].faces, single[i].faces);
    EXPECT_EQ(many[i].common, single[i].common);
  }
}

TEST(SelfIntersections, SurviveAnySoup) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const PolygonSoup soup = random_soup(seed, 40, 200);
    for (const SelfIntersection& s : found_in(soup)) {
      EXPECT_LT(s.faces[0], s.faces[1]);
      EXPECT_FALSE(s.common.empty());
      for (const Vec3& p : s.common) EXPECT_TRUE(p.allFinite());
    }
  }
}

TEST(SelfIntersections, EndWhenCancelled) {
  Context context;
  context.cancel();
  const PolygonSoup soup = grid(5, 5);
  EXPECT_THROW(find_self_intersections(soup.points, triangulate(soup).triangles, Progress(context)), Error);
}

}  // namespace
}  // namespace hybrid_mesh
