// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/map_clipping.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "hierarchy/bases.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {
namespace {

Vec3 bent(double u, double v) { return {2 * u, v + 0.3 * u * v, std::sin(3 * u) * v}; }

// The squares of a grid of 2^level x 2^level, and how they lie side by side.
std::vector<DyadicSquare> grid(int level) {
  std::vector<DyadicSquare> squares{{}};
  for (int k = 0; k < level; ++k) {
    std::vector<DyadicSquare> finer;
    for (const DyadicSquare& s : squares)
      for (int i = 0; i < 4; ++i) finer.push_back(s.quadrant(i));
    squares = finer;
  }
  return squares;
}
QuadGraph grid_graph(int level) {
  QuadGraph graph{{{0, 1, 2, 3}}, {{}}, 4};
  for (int k = 0; k < level; ++k) graph = quadrisected(graph);
  return graph;
}

TEST(MapClipping, PartsTileTheMapAndSayTheSame) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  // With 8 columns many vertices lie on the lines, with 7 none do.
  for (const int n : {1, 7, 8}) {
    const PatchMap map = make_map(n, n == 8 ? 0 : 0.3, n, bent);
    const PatchSampler whole(map);
    for (const int level : {1, 2, 4}) {
      const std::vector<DyadicSquare> squares = grid(level);
      const std::vector<PatchMap> parts = clip_map(map, squares);
      ASSERT_EQ(parts.size(), squares.size());
      double area = 0;
      for (std::size_t k = 0; k < parts.size(); ++k) {
        ASSERT_STREQ(find_map_defect(parts[k]), "");
        for (const auto& t : parts[k].triangles)
          area += (parts[k].positions[t[1]] - parts[k].positions[t[0]]).cross(parts[k].positions[t[2]] - parts[k].positions[t[0]]).norm();
        const PatchSampler part(parts[k]);
        for (int i = 0; i < 20; ++i) {
          const double u = uniform(random), v = uniform(random);
          const PatchSample a = whole(squares[k].u + u * squares[k].width, squares[k].v + v * squares[k].width), b = part(u, v);
          EXPECT_NEAR((a.position - b.position).norm(), 0, 1e-12);
          Vec2 from_a = Vec2::Zero(), from_b = Vec2::Zero();  // sources are triangles of the map itself here
          for (int c = 0; c < 3; ++c) {
            from_a += a.source.weights[c] * map.uv[map.triangles[a.source.face][c]];
            from_b += b.source.weights[c] * map.uv[map.triangles[b.source.face][c]];
          }
          EXPECT_NEAR((from_a - from_b).norm(), 0, 1e-5);
        }
      }
      double all = 0;
      for (const auto& t : map.triangles) all += (map.positions[t[1]] - map.positions[t[0]]).cross(map.positions[t[2]] - map.positions[t[0]]).norm();
      EXPECT_NEAR(area, all, 1e-9 * all);
      // They share the points on their sides, so that they can be joined again.
      const GluedMaps glued = glue_patch_maps(parts, grid_graph(level));
      int boundary = 0;
      for (const int h : glued.mapped.surface.mesh.opposite) boundary += h < 0;
      EXPECT_LE(boundary, 4 * (n + (1 << level)));
    }
  }
}

TEST(MapClipping, ASingleSquareIsCutOutAlone) {
  const PatchMap map = make_map(15, 0.3, 5, bent);
  const DyadicSquare square{0.25, 0.5, 0.125};
  const PatchMap part = clip_map(map, {square})[0];
  EXPECT_STREQ(find_map_defect(part), "");
  EXPECT_LT(part.triangles.size(), map.triangles.size() / 4);
  for (std::size_t v = 0; v < part.uv.size(); ++v) {
    const Vec2 uv = Vec2(square.u, square.v) + square.width * part.uv[v];
    EXPECT_NEAR((PatchSampler(map)(uv.x(), uv.y()).position - part.positions[v]).norm(), 0, 1e-12);
  }
  // All of it is the map itself.
  const PatchMap same = clip_map(map, {DyadicSquare{}})[0];
  EXPECT_EQ(same.triangles, map.triangles);
}

TEST(MapClipping, GluedMapsTraceTheirSources) {
  const PatchMap map = make_map(7, 0.3, 2, bent);
  const std::vector<PatchMap> parts = clip_map(map, grid(1));
  const GluedMaps glued = glue_patch_maps(parts, grid_graph(1));
  // A map over the glued surface's own faces, traced, names the first map's triangles.
  PatchMap own = parts[2];
  int first = 0;
  for (int q = 0; q < 2; ++q) first += static_cast<int>(parts[q].triangles.size());
  for (std::size_t t = 0; t < own.triangles.size(); ++t) {
    own.source_face[t] = first + static_cast<int>(t);
    own.source[t] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  }
  glued.trace(own);
  EXPECT_EQ(own.source_face, parts[2].source_face);
  EXPECT_EQ(own.source, parts[2].source);
}

// Neighbours whose maps are clipped at different times, to squares of different levels, have to share the points along their sides.
TEST(MapClipping, PointsAlongALineDoNotDependOnTheSquaresAskedFor) {
  for (const int n : {3, 7}) {
    const PatchMap map = make_map(n, 0.3, n, bent);
    // The points of a part along u = 1/2 of the map, between two heights.
    const auto points = [](const PatchMap& part, const DyadicSquare& square, double low, double high) {
      std::vector<double> out;
      for (const Vec2& uv : part.uv)
        if (const double v = square.v + square.width * uv.y(); square.u + square.width * uv.x() == 0.5 && v > low && v < high) out.push_back(v);
      std::sort(out.begin(), out.end());
      return out;
    };
    const DyadicSquare whole, left = whole.quadrant(0);
    const std::vector<double> coarse = points(clip_map(map, {left})[0], left, 0, 0.5);
    for (const DyadicSquare& right : {whole.quadrant(1).quadrant(0), whole.quadrant(1).quadrant(3), whole.quadrant(1).quadrant(0).quadrant(3)}) {
      const std::vector<double> fine = points(clip_map(map, {right})[0], right, right.v, right.v + right.width);
      std::vector<double> expected;
      for (const double v : coarse)
        if (v > right.v && v < right.v + right.width) expected.push_back(v);
      ASSERT_EQ(fine.size(), expected.size());
      for (std::size_t k = 0; k < fine.size(); ++k) EXPECT_NEAR(fine[k], expected[k], 1e-12);
    }
  }
}

}  // namespace
}  // namespace hybrid_mesh
