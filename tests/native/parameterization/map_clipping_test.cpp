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
  glued.on.trace(own);
  EXPECT_EQ(own.source_face, parts[2].source_face);
  EXPECT_EQ(own.source, parts[2].source);
}

// Neighbours whose maps are clipped at different times, to squares of different levels, have to share the points along their sides.
TEST(MapClipping, PointsAlongALineDoNotDependOnTheSquaresAskedFor) {
  for (const int n : {1, 3, 7}) {
    const PatchMap map = make_map(n, 0.3, n, bent);
    for (const int axis : {0, 1}) {
      // The points of a square's map along the line where the axis' coordinate is 1/2, inside the square's side.
      const auto points = [&](const DyadicSquare& square) {
        const double low = axis == 0 ? square.v : square.u;
        const std::vector<PatchMap> parts = clip_map(map, {square});
        std::vector<double> out;
        for (const Vec2& uv : parts[0].uv) {
          const Vec2 p = Vec2(square.u, square.v) + square.width * uv;
          if (p[axis] == 0.5 && p[1 - axis] > low && p[1 - axis] < low + square.width) out.push_back(p[1 - axis]);
        }
        std::sort(out.begin(), out.end());
        return out;
      };
      const DyadicSquare whole;
      const std::vector<double> coarse = points(whole.quadrant(0));
      const DyadicSquare across = whole.quadrant(axis == 0 ? 1 : 3);
      for (const DyadicSquare& fine : {across, across.quadrant(0), across.quadrant(axis == 0 ? 3 : 1), across.quadrant(0).quadrant(0)}) {
        const double low = axis == 0 ? fine.v : fine.u;
        std::vector<double> expected;
        for (const double at : coarse)
          if (at > low && at < low + fine.width) expected.push_back(at);
        const std::vector<double> found = points(fine);
        ASSERT_EQ(found.size(), expected.size()) << n << " " << axis << " " << fine.width;
        for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace hybrid_mesh
