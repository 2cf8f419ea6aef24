// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/operation_template.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "hierarchy/bases.h"
#include "hierarchy/irregular_operations.h"
#include "hierarchy/repatches.h"

namespace hybrid_mesh {
namespace {

// The four children of a cube's side that meet in its middle.
std::vector<int> middle_of(const HybridMesh& mesh, int side) {
  std::vector<int> nodes;
  for (int k = 0; k < 4; ++k) nodes.push_back(mesh.first_child(mesh.first_child(side) + k) + (k + 2) % 4);
  return nodes;
}

TEST(OperationTemplate, FitsAnyRegionWithAsManySides) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(2);
  const std::vector<std::array<int, 4>> star{{0, 1, 2, 8}, {2, 3, 4, 8}, {4, 5, 6, 8}, {6, 7, 0, 8}};
  const std::vector<int> first = middle_of(mesh, 0), second = middle_of(mesh, 1);
  ASSERT_EQ(mesh.apply(free_layout(mesh, first, star).repatch), "");
  const auto pattern = template_of(mesh, 0);
  ASSERT_TRUE(pattern);
  EXPECT_EQ(pattern->corners, 8);
  EXPECT_EQ(pattern->quads, star);
  EXPECT_NE(std::find(first.begin(), first.end(), pattern->start.node), first.end());
  EXPECT_EQ(mesh.half_edge(pattern->start.node, pattern->start.side), mesh.half_edge(mesh.operation(0).roots[0], 0));
  ASSERT_EQ(mesh.apply(free_layout(mesh, second, pattern->quads, mesh.half_edge(second[0], 0)).repatch), "");
  const auto copy = template_of(mesh, 1);
  ASSERT_TRUE(copy);
  EXPECT_EQ(copy->quads, pattern->quads);
  EXPECT_EQ(copy->start.node, second[0]);
  EXPECT_EQ(copy->start.side, 0);
}

TEST(OperationTemplate, CountsACubesNodes) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(1);
  ASSERT_EQ(mesh.apply(cube_on(mesh, mesh.first_child(3) + 1)), "");
  const auto pattern = template_of(mesh, 0);
  ASSERT_TRUE(pattern);
  EXPECT_EQ(pattern->corners, 4);
  EXPECT_EQ(pattern->quads, (std::vector<std::array<int, 4>>{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}}));
}

TEST(OperationTemplate, IsNothingWhereNoDiskIsReplacedByADisk) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(2);
  ASSERT_EQ(mesh.apply(opening(mesh, {middle_of(mesh, 0)[0]})), "");
  ASSERT_EQ(mesh.apply(tube_between(mesh, middle_of(mesh, 1)[0], middle_of(mesh, 3)[0], 0)), "");
  EXPECT_FALSE(template_of(mesh, 0));
  EXPECT_FALSE(template_of(mesh, 1));
}

}  // namespace
}  // namespace hybrid_mesh
