// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/modelling.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "subdivision/reference.h"

namespace hybrid_mesh {
namespace {

const FaceClosure kClosures[] = {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles};

// A flat grid of unit squares at the height 1.
HybridMesh placed_grid(int columns, int rows) {
  std::vector<Vec3> points;
  std::vector<std::array<int, 4>> quads;
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x <= columns; ++x) {
      const int a = y * (columns + 1) + x;
      points.push_back(Vec3(x + 1, y + 1, 1));
      if (x < columns && y < rows) quads.push_back({a, a + 1, a + columns + 2, a + columns + 1});
    }
  return make_base(points, quads);
}

HybridMesh refined(const HybridMesh& mesh, int level) {
  Context context;
  return refine(mesh, level, Progress(context));
}

ChangedHierarchy changed(const HybridMesh& mesh, const OperationDraft& draft) {
  Context context;
  return change(mesh, draft, Progress(context));
}

// Every point of every level and of the final mesh has been placed: none is left at the origin.
testing::AssertionResult all_placed(const HybridMesh& mesh) {
  const auto defects = find_defects(mesh);
  if (!defects.empty()) return testing::AssertionFailure() << defects[0];
  std::vector<QuadMesh> meshes{mesh.final_mesh()};
  for (int j = 0; j <= mesh.depth(); ++j)
    for (const LevelKind kind : {LevelKind::M, LevelKind::N}) meshes.push_back(mesh.level_mesh(j, kind));
  for (const QuadMesh& one : meshes)
    for (const Vec3& p : one.points)
      if (!(p.minCoeff() > 0.5 && p.maxCoeff() < 6)) return testing::AssertionFailure() << "a vertex at " << p.transpose();
  return testing::AssertionSuccess();
}

TEST(Modelling, AdaptiveHierarchiesHavePointsOnEveryLevelAndInEveryClosure) {
  for (const FaceClosure closure : kClosures)
    for (int deep = 0; deep < 9; ++deep) {
      HybridMesh mesh = refined(placed_grid(3, 3), 1);
      mesh.set_closure(closure);
      // Finer at one base quad, then refined with positions as far as level 1 only: what is finer is placed by the operation's step.
      for (int round = 0; round < 3; ++round) {
        std::vector<int> leaves;
        for (const int leaf : mesh.leaves())
          if (mesh.root(leaf) == deep) leaves.push_back(leaf);
        for (const int leaf : leaves) mesh.refine_balanced(leaf);
      }
      ASSERT_FALSE(mesh.conforming());
      mesh = refined(mesh, 1);
      ASSERT_TRUE(all_placed(mesh));
      const int child = mesh.first_child(4) + deep % 4;
      const ChangedHierarchy tower = changed(mesh, add_cubes(mesh, {child}, 1 + deep % 2));
      EXPECT_TRUE(all_placed(tower.hierarchy));
      EXPECT_EQ(tower.hierarchy.leaf_counts().euler, 1);
      EXPECT_EQ(tower.roots.size(), 1u + 4 * (1 + deep % 2));
      // What was there has stayed.
      const QuadMesh before = mesh.level_mesh(2), after = tower.hierarchy.level_mesh(2);
      PointMap points;
      for (std::size_t v = 0; v < before.vertex_count(); ++v) points[before.vertex[v]] = before.points[v];
      std::size_t common = 0;
      for (std::size_t v = 0; v < after.vertex_count(); ++v) {
        const auto found = points.find(after.vertex[v]);
        if (found == points.end()) continue;
        ++common;
        EXPECT_EQ(found->second, after.points[v]);
      }
      EXPECT_GT(common, before.vertex_count() / 2);
    }
}

TEST(Modelling, TheOriginalIsLeftAlone) {
  const HybridMesh mesh = refined(placed_grid(2, 2), 2);
  const int quads = static_cast<int>(mesh.leaves().size());
  const ChangedHierarchy hole = changed(mesh, open_boundary(mesh, {mesh.first_child(0)}));
  EXPECT_TRUE(hole.roots.empty());
  EXPECT_EQ(hole.hierarchy.leaves().size(), static_cast<std::size_t>(quads - 4));
  EXPECT_EQ(mesh.leaves().size(), static_cast<std::size_t>(quads));
  EXPECT_EQ(mesh.operation_count(), 0);
  EXPECT_THROW(changed(mesh, add_cubes(mesh, {0}, 1)), Error);
}

}  // namespace
}  // namespace hybrid_mesh
