// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/well_shaped.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "generated_surfaces.h"
#include "shapes.h"
#include "surface/closest_point.h"
#include "surface/distance.h"
#include "surface/edit_mesh.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TriangleSurface of_unit_size(const PolygonSoup& soup) {
  TriangleSurface surface = testing::repaired(soup);
  Vec3 low = surface.points[0], high = low;
  for (const Vec3& p : surface.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  for (Vec3& p : surface.points) p = (p - 0.5 * (low + high)) / (high - low).norm();
  return surface;
}

WellShaped shaped(const TriangleSurface& input, const WellShapedOptions& options) {
  Context context;
  return make_well_shaped(input, options, Progress(context));
}

double smallest_angle(const TriangleSurface& surface, int f) {
  double smallest = 4;
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = surface.points[surface.faces[f][i]];
    const Vec3 a = surface.points[surface.faces[f][(i + 1) % 3]] - p, b = surface.points[surface.faces[f][(i + 2) % 3]] - p;
    smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return smallest / kDegree;
}

int faces_below(const TriangleSurface& surface, double degrees) {
  int count = 0;
  for (int f = 0; f < static_cast<int>(surface.faces.size()); ++f) count += smallest_angle(surface, f) < degrees;
  return count;
}

Vec3 position(const TriangleSurface& surface, const SurfacePoint& place) {
  Vec3 p = Vec3::Zero();
  for (int k = 0; k < 3; ++k) p += place.weights[k] * surface.points[surface.faces[place.face][k]];
  return p;
}

// Length of the edges that have faces at an angle of more than `degrees`.
double sharp_length(const TriangleSurface& surface, double degrees) {
  const auto normal = [&](int f) {
    const auto& [a, b, c] = surface.faces[f];
    return (surface.points[b] - surface.points[a]).cross(surface.points[c] - surface.points[a]).normalized();
  };
  double length = 0;
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    const int o = surface.opposite[h];
    if (o > h && normal(h / 3).dot(normal(o / 3)) < std::cos(degrees * kDegree))
      length += (surface.points[surface.to(h)] - surface.points[surface.from(h)]).norm();
  }
  return length;
}

// What holds for every input.
void expect_same_surface(const TriangleSurface& input, const WellShaped& result, const WellShapedOptions& options) {
  const TopologySummary before = summarize_topology(to_soup(input)), after = summarize_topology(to_soup(result.mesh));
  EXPECT_EQ(after.euler, before.euler);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.boundary_loops, before.boundary_loops);
  EXPECT_EQ(after.nonmanifold_edges + after.nonmanifold_vertices + after.misoriented_edges, 0);
  EXPECT_LE(static_cast<std::int64_t>(result.mesh.points.size()),
            std::max<std::int64_t>(options.most_points, static_cast<std::int64_t>(input.points.size())));

  // The distance of a face is measured in some of its points only.
  const double near = 2 * options.tolerance;
  Context context;
  const SurfaceDistance distance = surface_distance(to_soup(input), to_soup(result.mesh), {20000, 1}, Progress(context));
  EXPECT_LE(distance.hausdorff, near);
  if (before.boundary_loops > 0) {
    EXPECT_LE(distance.boundary_hausdorff, near);
  }

  ASSERT_EQ(result.place.size(), result.mesh.points.size());
  for (std::size_t v = 0; v < result.place.size(); ++v) {
    const SurfacePoint& place = result.place[v];
    ASSERT_GE(place.face, 0);
    ASSERT_LT(place.face, static_cast<int>(input.faces.size()));
    for (const double w : place.weights) ASSERT_GE(w, 0);
    ASSERT_NEAR(place.weights[0] + place.weights[1] + place.weights[2], 1, 1e-12);
    // Points are on the input, not just near it.
    ASSERT_LE((position(input, place) - result.mesh.points[v]).norm(), 1e-12);
  }
  const SurfaceDistanceQuery query(input);
  ASSERT_EQ(result.mesh.source_face.size(), result.mesh.faces.size());
  for (std::size_t f = 0; f < result.mesh.faces.size(); ++f) {
    const auto& [a, b, c] = result.mesh.faces[f];
    const Vec3 centroid = (result.mesh.points[a] + result.mesh.points[b] + result.mesh.points[c]) / 3;
    ASSERT_LE(std::sqrt(query.squared_distance(centroid, result.mesh.source_face[f])), near);
  }
}

void expect_no_long_edges(const TriangleSurface& surface, const WellShapedOptions& options) {
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h)
    ASSERT_LE((surface.points[surface.to(h)] - surface.points[surface.from(h)]).norm(), options.longest_edge * (1 + 1e-12));
}

// A fan of n triangles around one point, which lies `height` above a rim of radius 1. `closed` adds the same from below.
PolygonSoup fan(int n, double height, bool closed) {
  PolygonSoup soup;
  for (int i = 0; i < n; ++i) soup.points.push_back(Vec3(std::cos(2 * std::numbers::pi * i / n), std::sin(2 * std::numbers::pi * i / n), 0));
  soup.points.push_back(Vec3(0, 0, height));
  soup.points.push_back(Vec3(0, 0, -height));
  for (int side = 0; side < (closed ? 2 : 1); ++side)
    for (int i = 0; i < n; ++i) {
      const int a = i, b = (i + 1) % n;
      soup.indices.insert(soup.indices.end(), {side ? b : a, side ? a : b, n + side});
      soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
    }
  return soup;
}

// A closed cylinder of n strips, each of two triangles from end to end, with fans for its ends.
PolygonSoup needle_cylinder(int n, double radius, double length) {
  PolygonSoup soup;
  for (int end = 0; end < 2; ++end)
    for (int i = 0; i < n; ++i)
      soup.points.push_back(Vec3(end * length, radius * std::cos(2 * std::numbers::pi * i / n), radius * std::sin(2 * std::numbers::pi * i / n)));
  soup.points.push_back(Vec3(0, 0, 0));
  soup.points.push_back(Vec3(length, 0, 0));
  const auto add = [&](int a, int b, int c) {
    soup.indices.insert(soup.indices.end(), {a, b, c});
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  };
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    add(i, n + j, n + i), add(i, j, n + j), add(j, i, 2 * n), add(n + i, n + j, 2 * n + 1);
  }
  return soup;
}

PolygonSoup stretched(PolygonSoup soup, const Vec3& factors) {
  for (Vec3& p : soup.points) p = p.cwiseProduct(factors);
  return soup;
}

// A prism whose ends are triangles with a corner of the given angle.
PolygonSoup wedge(double degrees) {
  const double a = degrees * kDegree;
  std::vector<Vec3> points;
  for (int end = 0; end < 2; ++end)
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(std::cos(a), std::sin(a), 0)}) points.push_back(p + Vec3(0, 0, 0.3 * end));
  return shapes::soup_of(points, {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}});
}

WellShapedOptions sized(double longest) {
  WellShapedOptions options;
  options.longest_edge = longest;
  options.shortest_edge = longest / 20;
  options.collapsible = longest / 2;
  return options;
}

TEST(WellShaped, LeavesWellShapedTrianglesAlone) {
  for (const PolygonSoup& soup : {testing::ball(16), testing::ball(16, 0.5), testing::torus(60, 24)}) {
    const TriangleSurface input = of_unit_size(soup);
    ASSERT_EQ(faces_below(input, WellShapedOptions().least_angle), 0);
    const WellShaped result = shaped(input, sized(0.2));
    EXPECT_TRUE(result.unchanged);
    EXPECT_EQ(result.mesh.points, input.points);
    EXPECT_EQ(result.mesh.faces, input.faces);
    for (std::size_t f = 0; f < input.faces.size(); ++f) ASSERT_EQ(result.mesh.source_face[f], static_cast<int>(f));
  }
}

TEST(WellShaped, RefinesBoxesKeepingTheirEdges) {
  for (const Vec3& sides : {Vec3(1, 1, 1), Vec3(1, 0.05, 1), Vec3(1, 0.04, 0.03), Vec3(1, 0.5, 0.002)}) {
    const TriangleSurface input = of_unit_size(stretched(shapes::cube(), sides));
    const WellShapedOptions options = sized(0.03);
    const WellShaped result = shaped(input, options);
    EXPECT_FALSE(result.unchanged);
    expect_same_surface(input, result, options);
    expect_no_long_edges(result.mesh, options);
    EXPECT_EQ(faces_below(result.mesh, options.least_angle), 0);
    EXPECT_NEAR(sharp_length(result.mesh, 45), 4 * sides.sum() / sides.norm(), 1e-9);
    for (const Vec3& corner : input.points)
      EXPECT_NE(std::find(result.mesh.points.begin(), result.mesh.points.end(), corner), result.mesh.points.end());
  }
}

TEST(WellShaped, MendsNeedles) {
  for (const int strips : {12, 64, 3000}) {
    const TriangleSurface input = of_unit_size(needle_cylinder(strips, 0.2, 1));
    WellShapedOptions options = sized(0.03);
    options.tolerance = 1e-4;  // that of chords of half the longest edge on this cylinder
    const WellShaped result = shaped(input, options);
    expect_same_surface(input, result, options);
    expect_no_long_edges(result.mesh, options);
    EXPECT_LE(faces_below(result.mesh, options.least_bent_angle), static_cast<int>(result.mesh.faces.size() / 200)) << strips;
    // As many as the sizes ask for, however many strips there were.
    EXPECT_LT(result.mesh.points.size(), 12000u) << strips;
  }
}

TEST(WellShaped, MendsFans) {
  for (const double height : {0.0, 0.5}) {
    const TriangleSurface input = of_unit_size(fan(2000, height, height > 0));
    WellShapedOptions options = sized(0.03);
    options.tolerance = 1e-4;
    const WellShaped result = shaped(input, options);
    expect_same_surface(input, result, options);
    expect_no_long_edges(result.mesh, options);
    // At the tip of a cone the input's angles stay.
    const double least = height > 0 ? options.least_bent_angle : 20;
    EXPECT_LE(faces_below(result.mesh, least), height > 0 ? static_cast<int>(result.mesh.faces.size() / 50) : 0) << height;
    EXPECT_LT(result.mesh.points.size(), 20000u) << height;
  }
}

TEST(WellShaped, EndsAtSmallCorners) {
  for (const double degrees : {1.0, 5.0, 15.0}) {
    const TriangleSurface input = of_unit_size(wedge(degrees));
    const WellShapedOptions options = sized(0.05);
    const WellShaped result = shaped(input, options);
    expect_same_surface(input, result, options);
    expect_no_long_edges(result.mesh, options);
    EXPECT_LT(result.mesh.points.size(), 20000u) << degrees;
    // What is left of small angles is near the corner.
    EXPECT_LE(faces_below(result.mesh, 20), static_cast<int>(result.mesh.faces.size() / 10)) << degrees;
  }
}

TEST(WellShaped, AddsNoMorePointsThanAllowed) {
  const TriangleSurface input = of_unit_size(needle_cylinder(64, 0.2, 1));
  WellShapedOptions options = sized(0.01);
  options.most_points = 1500;
  const WellShaped result = shaped(input, options);
  expect_same_surface(input, result, options);
  EXPECT_GT(result.mesh.points.size(), 1400u);
}

TEST(WellShaped, KeepsFolds) {
  // A flat strip that is folded back onto itself: flipping the fold's edges would move nothing off the surface, and lose the flap.
  const TriangleSurface input =
      of_unit_size(shapes::soup_of({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.6, 0.1, 0}, {0.6, 0.9, 0}}, {{0, 1, 2, 3}, {2, 1, 4, 5}}));
  const WellShapedOptions options = sized(0.1);
  expect_same_surface(input, shaped(input, options), options);
}

TEST(WellShaped, IsTheSameEveryTime) {
  const TriangleSurface input = of_unit_size(needle_cylinder(200, 0.1, 1));
  const WellShaped a = shaped(input, sized(0.02)), b = shaped(input, sized(0.02));
  EXPECT_EQ(a.mesh.points, b.mesh.points);
  EXPECT_EQ(a.mesh.faces, b.mesh.faces);
  EXPECT_EQ(a.mesh.source_face, b.mesh.source_face);
}

TEST(WellShaped, MeetsRandomSoup) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const TriangleSurface input = of_unit_size(shapes::random_soup(seed, 12, 14));
    if (input.empty()) continue;
    WellShapedOptions options = sized(0.1);
    options.shortest_edge = 0.02;
    expect_same_surface(input, shaped(input, options), options);
    if (HasFailure()) FAIL() << "seed " << seed;
  }
}

TEST(EditMesh, SplitsEdges) {
  for (const PolygonSoup& soup : {testing::ball(3), testing::ball(3, 0.3)}) {
    const TriangleSurface input = testing::repaired(soup);
    EditMesh mesh(input);
    const int edges = mesh.edge_count, vertices = mesh.vertex_count;
    std::vector<char> done(edges, 0);
    int splits = 0;
    const int half_edges = static_cast<int>(mesh.origin.size());
    for (int h = 0; h < half_edges; ++h) {
      if (done[mesh.edge[h]]) continue;
      done[mesh.edge[h]] = 1;
      const int a = mesh.from(h), b = mesh.to(h), m = mesh.split(h);
      EXPECT_EQ(m, vertices + splits++);
      EXPECT_EQ(mesh.from(h), a);
      EXPECT_EQ(mesh.to(h), m);
      EXPECT_TRUE(mesh.adjacent(m, b));
      done.resize(mesh.edge_count, 1);
    }
    EXPECT_GT(splits, edges / 3);
    for (int h = 0; h < static_cast<int>(mesh.origin.size()); ++h) {
      const int o = mesh.opposite[h];
      if (o >= 0) {
        EXPECT_EQ(mesh.opposite[o], h);
        EXPECT_EQ(mesh.edge[o], mesh.edge[h]);
        EXPECT_EQ(mesh.from(o), mesh.to(h));
      } else {
        EXPECT_EQ(mesh.out[mesh.from(h)], h);
      }
    }
    EXPECT_EQ(mesh.vertex_count, vertices + splits);
    for (int v = 0; v < static_cast<int>(mesh.out.size()); ++v) EXPECT_EQ(mesh.from(mesh.out[v]), v);
  }
}

}  // namespace
}  // namespace hybrid_mesh
