// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/topology_summary.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

struct Expected {
  double genus;
  std::int64_t components, loops;
};

void expect_topology(const PolygonSoup& soup, const Expected& expected) {
  const TopologySummary t = summarize_topology(soup);
  EXPECT_EQ(t.genus, expected.genus);
  EXPECT_EQ(t.components, expected.components);
  EXPECT_EQ(t.boundary_loops, expected.loops);
  EXPECT_EQ(t.nonmanifold_edges, 0);
  EXPECT_EQ(t.nonmanifold_vertices, 0);
  EXPECT_EQ(t.misoriented_edges, 0);
  EXPECT_EQ(t.euler, t.vertices - t.edges + t.faces);
  EXPECT_EQ(t.faces, static_cast<std::int64_t>(soup.polygon_count()));
}

TEST(TopologySummary, OfManifolds) {
  expect_topology(cube(), {0, 1, 0});
  expect_topology(tetrahedron(), {0, 1, 0});
  expect_topology(grid(3, 4), {0, 1, 1});
  expect_topology(glued_rectangle(8, 6, false, true), {1, 1, 0});
  expect_topology(glued_rectangle(8, 2, false, false), {0, 1, 2});
  PolygonSoup several = cube();
  append(several, glued_rectangle(8, 6, false, true));
  append(several, grid(2, 2));
  several.points.push_back({9, 9, 9});  // without a face: not counted
  expect_topology(several, {1, 3, 1});
  expect_topology({}, {0, 0, 0});
}

TEST(TopologySummary, CountsWhatIsNotManifold) {
  const std::vector<Vec3> points(7, Vec3::Zero());
  EXPECT_EQ(summarize_topology(soup_of(points, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}})).nonmanifold_edges, 1);
  EXPECT_EQ(summarize_topology(soup_of(points, {{0, 1, 2}, {0, 1, 3}})).misoriented_edges, 1);
  EXPECT_EQ(summarize_topology(soup_of(points, {{0, 1, 2}, {0, 3, 4}})).nonmanifold_vertices, 1);
  EXPECT_EQ(summarize_topology(soup_of(points, {{0, 1, 2}, {0, 3, 4}, {0, 5, 6}})).nonmanifold_vertices, 1);
  EXPECT_EQ(summarize_topology(glued_rectangle(9, 2, true, false)).boundary_loops, 1);
  EXPECT_GT(summarize_topology(glued_rectangle(9, 2, true, false)).misoriented_edges, 0);
}

TEST(TopologySummary, RefusesIndicesOutOfRange) { EXPECT_THROW(summarize_topology(soup_of({{0, 0, 0}}, {{0, 1, 2}})), Error); }

TEST(TopologySummary, SoupOfASurface) {
  TriangleSurface surface;
  surface.points = tetrahedron().points;
  surface.faces = {{0, 2, 1}, {0, 1, 3}};
  const PolygonSoup soup = to_soup(surface);
  EXPECT_EQ(soup.points, surface.points);
  EXPECT_EQ(soup.indices, (std::vector<std::int32_t>{0, 2, 1, 0, 1, 3}));
  EXPECT_EQ(soup.offsets, (std::vector<std::int64_t>{0, 3, 6}));
}

}  // namespace
}  // namespace hybrid_mesh
