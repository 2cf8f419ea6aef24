// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/feature_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "generated_surfaces.h"
#include "models.h"
#include "sharp_shapes.h"
#include "surface/placement.h"

namespace hybrid_mesh {
namespace {

TriangleSurface unit(const PolygonSoup& soup) {
  TriangleSurface surface = testing::repaired(soup);
  const Placement placement = placement_of(surface.points);
  for (Vec3& p : surface.points) p = placement.to_unit(p);
  return surface;
}

long count(const std::vector<char>& marks) {
  return std::count_if(marks.begin(), marks.end(), [](char c) { return c != 0; });
}

FeatureGraph automatic(const TriangleSurface& surface) { return find_features(surface, FeatureOptions()); }

TEST(FeatureGraph, HasTheEdgesAndCornersOfSolids) {
  const struct {
    PolygonSoup soup;
    long edges, corners;
  } cases[] = {{shapes::cube(), 12, 8}, {shapes::l_prism(), 18, 12}, {shapes::frame(), 24, 16}};
  for (const auto& c : cases) {
    const TriangleSurface surface = unit(c.soup);
    const FeatureGraph graph = automatic(surface);
    ASSERT_FALSE(graph.empty());
    EXPECT_EQ(count(graph.edges), 2 * c.edges);
    EXPECT_EQ(count(graph.corners), c.corners);
    for (std::size_t h = 0; h < graph.edges.size(); ++h) EXPECT_EQ(graph.edges[h], graph.edges[surface.opposite[h]]);
  }
}

TEST(FeatureGraph, GoesAroundACylinderWithoutCorners) {
  const TriangleSurface surface = unit(shapes::cylinder(48, 3));
  const FeatureGraph graph = automatic(surface);
  EXPECT_EQ(count(graph.edges), 2 * 2 * 48);
  EXPECT_EQ(count(graph.corners), 0);
  const std::vector<int> component = curve_components(surface, graph.edges);
  EXPECT_EQ(std::set<int>(component.begin(), component.end()).size(), 2u);  // every point is on one of the rims
}

TEST(FeatureGraph, IsEmptyWhereEverythingBends) {
  for (const PolygonSoup& soup : {testing::ball(4), testing::ball(20), testing::torus(20, 12), testing::torus(40, 30)})
    EXPECT_TRUE(automatic(unit(soup)).empty());
}

TEST(FeatureGraph, NoiseIsNoFeatureAndHidesNone) {
  // A cube of 20 x 20 quads a face, of which every point is moved by a hundredth of a quad.
  PolygonSoup soup;
  const int n = 20;
  shapes::TestRandom random(5);
  for (int axis = 0; axis < 3; ++axis)
    for (const int end : {0, n}) {
      const int first = static_cast<int>(soup.points.size());
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          Vec3 p;
          p[axis] = end, p[(axis + 1) % 3] = end ? i : j, p[(axis + 2) % 3] = end ? j : i;
          soup.points.push_back(p);
        }
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const int at = first + i * (n + 1) + j;
          soup.indices.insert(soup.indices.end(), {at, at + n + 1, at + n + 2, at + 1});
          soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
        }
    }
  TriangleSurface surface = unit(soup);  // merges the faces' rims
  for (Vec3& p : surface.points)
    for (int i = 0; i < 3; ++i) p[i] += 0.01 * (random.unit() - 0.5) / n;
  const FeatureGraph graph = automatic(surface);
  EXPECT_EQ(count(graph.edges), 2 * 12 * n);
  EXPECT_EQ(count(graph.corners), 8);
}

TEST(FeatureGraph, AGivenAngleTakesAllEdgesFromThereOn) {
  const TriangleSurface surface = unit(shapes::cylinder(24, 3));  // its walls meet at 15 degrees
  FeatureOptions options;
  options.crispness = options.least_total = 0;
  options.most_left = 1e9;
  options.angle = options.weak_angle = 10;
  EXPECT_EQ(count(find_features(surface, options).edges), 2 * 3 * 24);
  options.angle = options.weak_angle = 95;
  EXPECT_TRUE(find_features(surface, options).empty());
}

TEST(FeatureGraph, EndsAtABoundary) {
  PolygonSoup open = shapes::cube();
  open.indices.resize(open.indices.size() - 4);
  open.offsets.pop_back();
  const TriangleSurface surface = unit(open);
  const FeatureGraph graph = automatic(surface);
  EXPECT_EQ(count(graph.edges), 2 * 8 + 4);  // and around the hole, where edges have one half-edge
  EXPECT_EQ(count(graph.corners), 8);
}

TEST(FeatureGraph, HasTheBoundaryOfAPlate) {
  const auto corners_of = [](const PolygonSoup& soup) { return count(automatic(unit(soup)).corners); };
  EXPECT_EQ(corners_of(shapes::grid(1, 1)), 4);
  EXPECT_EQ(corners_of(shapes::grid(12, 8)), 4);
  const TriangleSurface plate = unit(shapes::grid(12, 8));
  const FeatureGraph graph = automatic(plate);
  for (std::size_t h = 0; h < graph.edges.size(); ++h) EXPECT_EQ(graph.edges[h] != 0, plate.opposite[h] < 0);
  FeatureOptions inner_only;
  inner_only.polygons = false;
  EXPECT_TRUE(find_features(plate, inner_only).empty());
}

TEST(FeatureGraph, IsEmptyWhereTheBoundaryIsRoundOrRough) {
  // A ball's lower half: round where it ends.
  EXPECT_TRUE(automatic(unit(testing::ball(16, 0))).empty());
  // A plate whose rim goes in and out at every vertex.
  PolygonSoup rough = shapes::grid(20, 20);
  for (std::size_t i = 0; i < rough.points.size(); ++i) {
    Vec3& p = rough.points[i];
    const bool on_rim = p.x() <= 0 || p.x() >= 20 || p.y() <= 0 || p.y() >= 20;
    if (on_rim && i % 2 == 0) p += 0.4 * (Vec3(10, 10, 0) - Vec3(p.x(), p.y(), 0)).normalized();
  }
  EXPECT_TRUE(automatic(unit(rough)).empty());
}

TEST(FeatureGraph, ScansHaveNone) {
  if (real_models().empty()) GTEST_SKIP() << no_models();
  for (const char* name : {"bunny.ply", "camel.ply", "elephant_holes.ply", "foot_bones.ply", "mannequin.ply", "max_planck.ply", "buddha_10k.ply"})
    EXPECT_TRUE(automatic(unit(read_polygon_soup((models_folder() / name).string()))).empty()) << name;
  for (const char* name : {"fandisk.ply", "mechanical/gear.off", "mechanical/octagonal_pocket.ply", "mechanical/crank.ply"})
    EXPECT_FALSE(automatic(unit(read_polygon_soup((models_folder() / name).string()))).empty()) << name;
}

}  // namespace
}  // namespace hybrid_mesh
