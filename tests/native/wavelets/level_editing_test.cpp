// SPDX-License-Identifier: GPL-3.0-or-later
#include "wavelets/level_editing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "wavelets/hierarchies.h"

namespace hybrid_mesh {
namespace {

// All meshes of a hierarchy, in one order.
struct Shown {
  std::string name;
  int level;  // of the final mesh: one more than the finest
  QuadMesh mesh;
};

std::vector<Shown> shown(const HybridMesh& hierarchy) {
  std::vector<Shown> result;
  for (int level = 0; level <= hierarchy.depth(); ++level)
    for (const LevelKind kind : {LevelKind::M, LevelKind::N})
      result.push_back({(kind == LevelKind::M ? "M" : "N") + std::to_string(level), level, hierarchy.level_mesh(level, kind)});
  result.push_back({"final", hierarchy.depth() + 1, hierarchy.final_mesh()});
  return result;
}

// Every level has positions of its own: stars of any shape, details as large as the quads.
HybridMesh randomly_placed(HybridMesh hierarchy, unsigned seed) {
  std::mt19937 random(seed);
  for (int level = 0; level <= hierarchy.depth(); ++level)
    for (const LevelKind kind : {LevelKind::M, LevelKind::N})
      hierarchy.set_level_positions(level, randomly_placed(hierarchy.level_mesh(level, kind), random));
  hierarchy.set_final_positions(randomly_placed(hierarchy.final_mesh(), random));
  return hierarchy;
}

// A bumpy torus of 8 x 8 base quads, each level on the surface for itself.
HybridMesh bumpy_torus(int depth) {
  HybridMesh hierarchy = torus(8, 8);
  hierarchy.refine_uniform(depth);
  for (int q = 0; q < hierarchy.base_count(); ++q) {
    const int x = q % 8, y = q / 8;
    hierarchy.set_map(q, make_map(8, 0, 1, [&](double u, double v) {
                        const double a = (x + u) / 4 * std::numbers::pi, b = (y + v) / 4 * std::numbers::pi;
                        const double radius = 1 + 0.1 * std::sin(5 * a + 1) * std::sin(7 * b);
                        return Vec3((3 + radius * std::cos(b)) * std::cos(a), (3 + radius * std::cos(b)) * std::sin(a), radius * std::sin(b));
                      }));
  }
  return hierarchy;
}

HybridMesh changed(const HybridMesh& hierarchy, const LevelEdit& edit) {
  Context context;
  HybridMesh result = edited(hierarchy, edit, Progress(context));
  EXPECT_EQ(context.progress(), 1);
  return result;
}

HybridMesh changed(const HybridMesh& hierarchy, int level, const std::vector<Vec3>& points, CoarserLevels coarser = CoarserLevels::Stay) {
  return changed(hierarchy, {level, LevelKind::N, points, coarser});
}

const Eigen::Matrix3d kTurn = Eigen::AngleAxisd(2.2, Vec3(1, -2, 3).normalized()).toRotationMatrix();
const Vec3 kShift(3, -1, 2);

TEST(LevelEditing, ASimilarityOfALevelIsOneOfAllFinerLevels) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    const HybridMesh hierarchy = randomly_placed(tried.mesh, 1);
    // Of two points nobody can say how they have turned.
    for (int level = hierarchy.base_vertex_count() < 3; level <= hierarchy.depth(); ++level)
      for (const LevelKind kind : {LevelKind::M, LevelKind::N})
        for (const double scale : {1.0, 2.5}) {
          const QuadMesh edit = transformed(hierarchy.level_mesh(level, kind), scale * kTurn, kShift);
          const std::vector<Shown> before = shown(hierarchy), after = shown(changed(hierarchy, {level, kind, edit.points, CoarserLevels::Stay}));
          for (std::size_t i = 0; i < before.size(); ++i) {
            const bool follows = before[i].level >= level;
            const std::vector<Vec3> expected = follows ? transformed(before[i].mesh, scale * kTurn, kShift).points : before[i].mesh.points;
            EXPECT_LE(farthest(after[i].mesh.points, expected), follows ? 1e-10 : 0) << level << before[i].name;
          }
        }
  }
}

TEST(LevelEditing, WhatALevelWasChangesNothing) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    const HybridMesh hierarchy = randomly_placed(tried.mesh, 2);
    const std::vector<Shown> before = shown(hierarchy);
    for (int level = 0; level <= hierarchy.depth(); ++level)
      for (const LevelKind kind : {LevelKind::M, LevelKind::N})
        for (const CoarserLevels coarser : {CoarserLevels::Stay, CoarserLevels::Follow}) {
          const std::vector<Shown> after = shown(changed(hierarchy, {level, kind, hierarchy.level_mesh(level, kind).points, coarser}));
          for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(before[i].mesh.points, after[i].mesh.points);
        }
  }
}

TEST(LevelEditing, FarFromAnEditNothingChanges) {
  const HybridMesh hierarchy = bumpy_torus(3);
  for (int level = 0; level <= 3; ++level) {
    QuadMesh mesh = hierarchy.level_mesh(level);
    const double width = std::ldexp(1.0, -level);  // of a quad, in base quads
    const std::size_t v = mesh.vertex_count() / 2 + 1;
    mesh.points[v] += Vec3(0.3, 0.1, -0.2) * width;
    const std::vector<Shown> before = shown(hierarchy), after = shown(changed(hierarchy, level, mesh.points));
    // Where a vertex lies on the torus, in base quads.
    const auto place = [](const QuadMesh& of, std::size_t vertex) {
      const MapLocation& location = of.location[vertex];
      const int column = location.node % 8, row = location.node / 8;
      return Vec2(column + location.u, row + location.v);
    };
    for (std::size_t i = 0; i < before.size(); ++i) {
      int moved = 0;
      for (std::size_t w = 0; w < before[i].mesh.vertex_count(); ++w) {
        if (before[i].mesh.points[w] == after[i].mesh.points[w]) continue;
        ++moved;
        Vec2 way = (place(before[i].mesh, w) - place(mesh, v)).cwiseAbs();
        way = way.cwiseMin(Vec2(8, 8) - way);
        // Subdivision reaches two quads far, and a frame to the next vertex on every level.
        EXPECT_LE(way.maxCoeff(), 4 * width) << level << before[i].name;
      }
      EXPECT_EQ(moved == 0, before[i].level < level);
      EXPECT_TRUE(moved == 1 || before[i].level != level);
    }
  }
}

TEST(LevelEditing, DetailsTurnWithTheSurface) {
  // A half of the torus turned about an axis, and what is between it and the other twisted.
  const HybridMesh hierarchy = bumpy_torus(4);
  const auto bent = [](QuadMesh mesh) {
    for (Vec3& point : mesh.points) {
      const double share = std::clamp((point.x() + 1) / 2, 0.0, 1.0);
      point = Eigen::AngleAxisd(1.2 * share, Vec3::UnitX()) * point;
    }
    return mesh;
  };
  const std::vector<Shown> before = shown(hierarchy), after = shown(changed(hierarchy, 2, bent(hierarchy.level_mesh(2)).points));
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].level < 3) continue;
    const QuadMesh expected = bent(before[i].mesh);
    int rigid = 0;
    for (std::size_t v = 0; v < expected.vertex_count(); ++v) {
      const double x = before[i].mesh.points[v].x();
      if (std::abs(x) < 3.2) continue;
      ++rigid;
      EXPECT_LT((after[i].mesh.points[v] - expected.points[v]).norm(), 1e-12) << before[i].name;
    }
    EXPECT_GT(rigid, 20);
  }
}

TEST(LevelEditing, AnOperationTurnsWithItsRim) {
  HybridMesh hierarchy = grid(9, 2);
  hierarchy.refine_uniform(1);
  const auto at = [&](double x) {  // the quad of level 1 whose lower corner is there
    for (const int node : active_nodes(hierarchy, 1)) {
      const int root = hierarchy.root(node);
      if (root / 9 == 0 && root % 9 + hierarchy.square_in(node, root).u == x && hierarchy.square_in(node, root).v == 0.5) return node;
    }
    return -1;
  };
  ASSERT_EQ(hierarchy.apply(cube_on(hierarchy, at(1))), "");
  ASSERT_EQ(hierarchy.apply(cube_on(hierarchy, at(7.5))), "");
  hierarchy.refine_uniform(3);
  hierarchy = randomly_placed(hierarchy, 3);
  // Quads beyond the middle, and all of them on level 0, where vertices are numbered in rows of ten.
  QuadMesh base = hierarchy.level_mesh(0);
  for (std::size_t v = 0; v < base.vertex_count(); ++v)
    if (base.vertex[v].index() % 10 >= 5) base.points[v] = kTurn * base.points[v] + kShift;
  const HybridMesh after = changed(hierarchy, 0, base.points);
  const auto new_vertices = [](const HybridMesh& of, int operation) {
    std::vector<Vec3> points;
    const QuadMesh mesh = of.level_mesh(1);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
      if (mesh.vertex[v].kind() == VertexId::Kind::Free && mesh.vertex[v].index() >= of.operation(operation).first_vertex &&
          mesh.vertex[v].index() < of.operation(operation).first_vertex + 4)
        points.push_back(mesh.points[v]);
    EXPECT_EQ(points.size(), 4U);
    return points;
  };
  EXPECT_EQ(new_vertices(hierarchy, 0), new_vertices(after, 0));
  std::vector<Vec3> expected = new_vertices(hierarchy, 1);
  for (Vec3& point : expected) point = kTurn * point + kShift;
  EXPECT_LT(farthest(new_vertices(after, 1), expected), 1e-12);
}

TEST(LevelEditing, CoarserLevelsFollowIfAsked) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    const HybridMesh hierarchy = randomly_placed(tried.mesh, 4);
    const int level = hierarchy.depth();
    const QuadMesh edit = transformed(hierarchy.level_mesh(level), 1.5 * kTurn, kShift);
    const std::vector<Shown> before = shown(hierarchy), after = shown(changed(hierarchy, level, edit.points, CoarserLevels::Follow));
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i].mesh.vertex_count() < 3) continue;
      EXPECT_LT(farthest(after[i].mesh.points, transformed(before[i].mesh, 1.5 * kTurn, kShift).points), 1e-8) << before[i].name;
    }
  }
}

TEST(LevelEditing, ASmoothEditReachesCoarserLevelsAsItIs) {
  // What subdivision makes of a change of level 0 takes level 0 along when it is made on level 1.
  const HybridMesh hierarchy = bumpy_torus(2);
  QuadMesh base = hierarchy.level_mesh(0);
  const std::size_t v = 20;
  base.points[v] += Vec3(0, 0, 0.5);
  const HybridMesh smooth = changed(hierarchy, 0, base.points);
  const QuadMesh fine = hierarchy.level_mesh(1);
  const SubdivisionOptions options;
  std::vector<Vec3> points = fine.points;
  const QuadMesh from = subdivided(hierarchy, hierarchy.level_mesh(0), 0, 1, options).mesh, to = subdivided(hierarchy, base, 0, 1, options).mesh;
  for (std::size_t w = 0; w < points.size(); ++w) points[w] += to.points[w] - from.points[w];
  const HybridMesh after = changed(hierarchy, 1, points, CoarserLevels::Follow);
  const QuadMesh followed = after.level_mesh(0);
  EXPECT_NEAR((followed.points[v] - base.points[v]).norm(), 0, 0.05);
  double others = 0;
  for (std::size_t w = 0; w < base.vertex_count(); ++w)
    if (w != v) others = std::max(others, (followed.points[w] - base.points[w]).norm());
  // The others turn a little.
  EXPECT_LT(others, 0.1);
}

TEST(LevelEditing, WrongEditsAreRefused) {
  const HybridMesh hierarchy = bumpy_torus(2);
  std::vector<Vec3> points = hierarchy.level_mesh(1).points;
  EXPECT_THROW(changed(hierarchy, 3, points), Error);
  EXPECT_THROW(changed(hierarchy, -1, points), Error);
  EXPECT_THROW(changed(hierarchy, 0, points), Error);
  points[7].z() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(changed(hierarchy, 1, points), Error);
  Context context;
  context.cancel();
  EXPECT_THROW(
      edited(hierarchy, {0, LevelKind::N, transformed(hierarchy.level_mesh(0), kTurn, kShift).points, CoarserLevels::Stay}, Progress(context)),
      Error);
}

}  // namespace
}  // namespace hybrid_mesh
