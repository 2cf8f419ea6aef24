// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/patch_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numeric>

#include "hierarchy/bases.h"

namespace hybrid_mesh {
namespace {

Vec3 bent(double u, double v) { return {2 * u, v + 0.3 * u * v, std::sin(3 * u) * v}; }

TEST(PatchMap, SamplesInterpolateTheTriangleThatHoldsThem) {
  for (int n : {1, 2, 7, 15}) {
    const PatchMap map = make_map(n, 0.3, n, bent);
    ASSERT_STREQ(find_map_defect(map), "");
    const PatchSampler sampler(map);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 500; ++i) {
      double u = uniform(random), v = uniform(random);
      if (i % 5 == 0) u = i % 2;  // sides and corners too
      if (i % 7 == 0) v = i % 2;
      const PatchSample sample = sampler(u, v);
      // The source's weights are the barycentrics in the triangle itself here.
      const auto& t = map.triangles[sample.triangle];
      Vec2 uv = Vec2::Zero();
      Vec3 position = Vec3::Zero();
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(sample.source.weights[k], 0);
        uv += sample.source.weights[k] * map.uv[t[k]];
        position += sample.source.weights[k] * map.positions[t[k]];
      }
      EXPECT_NEAR(uv.x(), u, 1e-12);
      EXPECT_NEAR(uv.y(), v, 1e-12);
      EXPECT_NEAR((position - sample.position).norm(), 0, 1e-12);
      EXPECT_EQ(sample.source.face, sample.triangle);
    }
  }
}

TEST(PatchMap, VerticesAreFoundExactly) {
  const PatchMap map = make_map(9, 0.3, 3, bent);
  const PatchSampler sampler(map);
  for (std::size_t i = 0; i < map.uv.size(); ++i) EXPECT_NEAR((sampler(map.uv[i].x(), map.uv[i].y()).position - map.positions[i]).norm(), 0, 1e-14);
}

TEST(PatchMap, CellAreasAddUpToTheSurface) {
  const PatchMap map = make_map(6, 0.3, 5, bent);
  double whole = 0;
  for (const auto& t : map.triangles)
    whole += 0.5 * (map.positions[t[1]] - map.positions[t[0]]).cross(map.positions[t[2]] - map.positions[t[0]]).norm();
  std::vector<double> fine = cell_areas(map, 16);
  EXPECT_NEAR(std::accumulate(fine.begin(), fine.end(), 0.0), whole, 1e-12 * whole);
  const std::vector<double> coarse = cell_areas(map, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      double sum = 0;
      for (int k = 0; k < 4; ++k) sum += fine[(2 * y + k / 2) * 16 + 2 * x + k % 2];
      EXPECT_NEAR(sum, coarse[y * 8 + x], 1e-12 * whole);
    }
  for (double a : cell_areas(make_map(5, 0, 1, [](double u, double v) { return Vec3(3 * u, 2 * v, 0); }), 7)) EXPECT_NEAR(a, 6.0 / 49, 1e-13);
}

TEST(PatchMap, DefectsAreFound) {
  const PatchMap good = make_map(4, 0.2, 1, bent);
  EXPECT_STREQ(find_map_defect(good), "");
  PatchMap map = good;
  std::swap(map.triangles[3][0], map.triangles[3][1]);
  EXPECT_STRNE(find_map_defect(map), "");
  map = good;
  map.triangles.pop_back();
  map.source.pop_back();
  map.source_face.pop_back();
  EXPECT_STRNE(find_map_defect(map), "");
  map = good;
  map.uv[2].y() = 1e-17;  // off the side by less than any tolerance
  EXPECT_STRNE(find_map_defect(map), "");
  map = good;
  map.uv[6] = map.uv[12];
  EXPECT_STRNE(find_map_defect(map), "");
  map = good;
  map.triangles.push_back(map.triangles[0]);
  map.source.push_back(map.source[0]);
  map.source_face.push_back(0);
  EXPECT_STRNE(find_map_defect(map), "");
  map = good;
  map.triangles[0][0] = 1000;
  EXPECT_STRNE(find_map_defect(map), "");
  EXPECT_STRNE(find_map_defect(PatchMap{}), "");
}

}  // namespace
}  // namespace hybrid_mesh
