// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/stretch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numeric>

#include "hierarchy/bases.h"
#include "hierarchy/repatches.h"

namespace hybrid_mesh {
namespace {

TEST(Stretch, AffineMapsAreEvenAndAsAnisotropicAsTheirAxes) {
  HybridMesh mesh = grid(3, 2);
  for (int q = 0; q < 6; ++q) mesh.set_map(q, make_map(4, 0.3, q, [&](double u, double v) { return Vec3(3 * (q % 3 + u), 1.5 * (q / 3 + v), 0); }));
  mesh.refine_uniform(2);
  mesh.refine_balanced(mesh.leaves()[20]);
  mesh.refine_balanced(mesh.leaves()[20]);
  for (const QuadMesh& m : {mesh.level_mesh(0), mesh.level_mesh(2), mesh.final_mesh()}) {
    const LevelStretch s = level_stretch(mesh, m);
    ASSERT_EQ(s.stretch.size(), m.face_count());
    for (double x : s.stretch) EXPECT_NEAR(x, 1, 1e-9);
    for (double x : s.anisotropy) EXPECT_NEAR(x, 2, 1e-9);
  }
}

TEST(Stretch, IsTheAreaOfTheCellsOverTheirShareOfTheSquare) {
  HybridMesh mesh = grid(2, 1);
  for (int q = 0; q < 2; ++q)
    mesh.set_map(q, make_map(7, 0.3, q, [&](double u, double v) { return Vec3(q + u, v * v + v, std::sin(4 * u * v) * (1 - u) * u); }));
  mesh.refine_uniform(3);
  const QuadMesh level = mesh.level_mesh(3);
  const LevelStretch s = level_stretch(mesh, level);
  std::vector<double> ratio, weight;
  for (std::size_t f = 0; f < level.face_count(); ++f) {
    const auto areas = cell_areas(*mesh.map(level.root[f]), 8);
    const HybridMesh::Square square = mesh.square_in(level.node[f], level.root[f]);
    weight.push_back(areas[static_cast<std::size_t>(square.v * 8) * 8 + static_cast<std::size_t>(square.u * 8)]);
    ratio.push_back(64 * weight.back());
  }
  const double median = weighted_median(ratio, weight);
  for (std::size_t f = 0; f < level.face_count(); ++f) {
    EXPECT_NEAR(s.stretch[f], ratio[f] / median, 1e-9);
    EXPECT_GE(s.anisotropy[f], 1);
  }
}

TEST(Stretch, InsertedRootsCountByTheirLevel) {
  // A flat quad replaced by a cube whose faces each have the area of the quad: all is even.
  HybridMesh mesh = grid(1, 1);
  mesh.set_map(0, make_map(4, 0.2, 1, [](double u, double v) { return Vec3(4 * u, 4 * v, 0); }));
  mesh.refine_uniform(1);
  ASSERT_EQ(mesh.apply(cube_on(mesh, mesh.first_child(0))), "");
  for (int root : mesh.operation(0).roots) mesh.set_map(root, make_map(3, 0.2, root, [](double u, double v) { return Vec3(2 * u, 0, 2 * v); }));
  for (double x : level_stretch(mesh, mesh.level_mesh(1)).stretch) EXPECT_NEAR(x, 1, 1e-9);
}

TEST(Stretch, WithoutMapsEverythingIsEven) {
  HybridMesh mesh = cube();
  for (double x : level_stretch(mesh, mesh.final_mesh()).stretch) EXPECT_EQ(x, 1);
}

TEST(Stretch, TheWeightedMedianHalvesTheWeight) {
  EXPECT_EQ(weighted_median({}, {}), 0);
  EXPECT_EQ(weighted_median({3, 1, 2}, {1, 1, 1}), 2);
  EXPECT_EQ(weighted_median({3, 1, 2}, {5, 1, 1}), 3);
}

}  // namespace
}  // namespace hybrid_mesh
