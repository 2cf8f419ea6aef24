// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/completion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "decoder/forest/vertex_index.h"
#include "hierarchy/bases.h"
#include "subdivision/catmull_clark.h"
#include "subdivision/modelling.h"
#include "subdivision/reference.h"

namespace hybrid_mesh {
namespace {

const FaceClosure kClosures[] = {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles};

HybridMesh cube_base() {
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) points.push_back(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  return make_base(points, {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

HybridMesh completed(const HybridMesh& hierarchy) {
  Context context;
  return completed(hierarchy, UnrefinedQuads::Subdivided, Progress(context));
}

// The same with all its edges sharp.
HybridMesh sharp_cube_base() {
  HybridMesh base = cube_base();
  for (int quad = 0; quad < 6; ++quad)
    for (int side = 0; side < 4; ++side) base.set_sharp(quad, side);
  return base;
}

// By subdivision of the base alone.
QuadMesh subdivided(const HybridMesh& hierarchy, int level) {
  Context context;
  const QuadMesh base = hierarchy.level_mesh(0);
  SubdivisionOptions options;
  for (std::size_t i = 0; i < base.sharp.size(); ++i)
    if (base.sharp[i]) options.rules.creases.push_back({base.vertex[base.indices[i]], base.vertex[base.indices[i % 4 == 3 ? i - 3 : i + 1]], 10});
  return subdivide(hierarchy, base, 0, level, options, Progress(context)).mesh;
}

// A mesh of the hierarchy with the positions of another that has its vertices, as far as it does.
QuadMesh with_points(QuadMesh mesh, const QuadMesh& other) {
  const VertexIndex find(other.vertex);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    if (const int i = find(mesh.vertex[v]); i >= 0) mesh.points[v] = other.points[i];
  return mesh;
}

// Finer and finer towards a corner of one quad; every level where subdivision of the base has it.
HybridMesh adaptive(HybridMesh hierarchy, FaceClosure closure) {
  hierarchy.set_closure(closure);
  hierarchy.refine_uniform(1);
  for (int level = 1; level < 4; ++level) {
    int leaf = 0;
    while (hierarchy.first_child(leaf) >= 0) leaf = hierarchy.first_child(leaf);
    hierarchy.refine_balanced(leaf);
  }
  for (int level = 1; level <= hierarchy.depth(); ++level) {
    // Leaves that are split have vertices of the next level.
    const QuadMesh finer = with_points(hierarchy.level_mesh(level), subdivided(hierarchy, level + 1));
    hierarchy.set_level_positions(level, with_points(finer, subdivided(hierarchy, level)));
  }
  hierarchy.set_final_positions(with_points(hierarchy.final_mesh(), subdivided(hierarchy, hierarchy.depth() + (closure == FaceClosure::Quads))));
  return hierarchy;
}

PointMap points_of(const QuadMesh& mesh) {
  PointMap points;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) points[mesh.vertex[v]] = mesh.points[v];
  return points;
}

TEST(Completion, WhatIsSubdividedGoesOnBySubdivision) {
  for (const HybridMesh& base : {cube_base(), sharp_cube_base()})
    for (const FaceClosure closure : kClosures) {
      const HybridMesh given = adaptive(base, closure);
      ASSERT_FALSE(given.conforming());
      const HybridMesh complete = completed(given);
      ASSERT_TRUE(find_defects(complete).empty());
      EXPECT_TRUE(complete.conforming());
      EXPECT_EQ(complete.depth(), given.depth() + (closure == FaceClosure::Quads));
      for (int level = 0; level <= complete.depth(); ++level) {
        const QuadMesh mesh = complete.level_mesh(level);
        EXPECT_EQ(mesh.face_count(), std::size_t{6} << (2 * level));
        EXPECT_EQ(mesh.sharp.empty(), !base.has_sharp_sides());
        const PointMap expected = points_of(subdivided(complete, level));
        ASSERT_EQ(expected.size(), mesh.vertex_count());
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) EXPECT_LT((mesh.points[v] - expected.at(mesh.vertex[v])).norm(), 1e-12);
      }
    }
}

TEST(Completion, TheFinestQuadsStayWhereTheyAre) {
  for (const FaceClosure closure : kClosures) {
    HybridMesh given = adaptive(cube_base(), closure);
    QuadMesh moved = given.final_mesh();
    for (std::size_t v = 0; v < moved.vertex_count(); ++v) moved.points[v] += 0.01 * Vec3(std::sin(3.0 * v), std::cos(5.0 * v), 1);
    given.set_final_positions(moved);
    if (closure != FaceClosure::Quads) given.set_level_positions(given.depth(), moved);
    const HybridMesh complete = completed(given);
    const PointMap points = points_of(complete.final_mesh());
    const std::vector<int>& node = moved.node;
    int checked = 0;
    for (std::size_t f = 0; f < moved.face_count(); ++f) {
      if (given.level(node[f]) < given.depth()) continue;
      ++checked;
      moved.for_corners(f, [&](int v) { EXPECT_EQ(points.at(moved.vertex[v]), moved.points[v]); });
    }
    EXPECT_GT(checked, 3);
  }
}

TEST(Completion, AUniformHierarchyStaysAsItIs) {
  Context context;
  const HybridMesh given = refine(cube_base(), 3, Progress(context));
  const HybridMesh complete = completed(given);
  EXPECT_EQ(complete.node_count(), given.node_count());
  for (int level = 0; level <= 3; ++level) EXPECT_EQ(complete.level_mesh(level).points, given.level_mesh(level).points);
}

TEST(Completion, TooManyQuadsAreRefused) {
  HybridMesh hierarchy = cube_base();
  hierarchy.set_closure(FaceClosure::Transition);
  for (int level = 0; level < 12; ++level) {
    int leaf = 0;
    while (hierarchy.first_child(leaf) >= 0) leaf = hierarchy.first_child(leaf);
    hierarchy.refine_balanced(leaf);
  }
  try {
    completed(hierarchy);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
  }
}

}  // namespace
}  // namespace hybrid_mesh
