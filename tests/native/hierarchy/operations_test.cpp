// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "hierarchy/archive.h"
#include "hierarchy/bases.h"
#include "hierarchy/repatches.h"

namespace hybrid_mesh {
namespace {

testing::AssertionResult sound(const HybridMesh& mesh) {
  const auto defects = find_defects(mesh);
  if (defects.empty()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << defects.size() << " defects, first: " << defects[0];
}

// Links found by brute force from the names of corners; returns false if names do not tell sides apart.
bool check_links_by_corners(const HybridMesh& mesh) {
  std::map<std::pair<VertexId, VertexId>, SideLink> sides;
  std::map<std::pair<VertexId, VertexId>, int> edges;
  const std::vector<int> leaves = mesh.leaves();
  for (int n : leaves)
    for (int s = 0; s < 4; ++s) {
      const VertexId a = mesh.corner(n, s), b = mesh.corner(n, (s + 1) % 4);
      const int edge = mesh.half_edge(n, s) >> 1;
      if (a == b || !sides.try_emplace({a, b}, SideLink{n, s}).second ||
          edges.try_emplace({std::min(a, b), std::max(a, b)}, edge).first->second != edge)
        return false;
    }
  std::map<std::pair<VertexId, VertexId>, SideLink> halves;  // of coarser sides
  for (const auto& [ends, side] : sides) {
    const VertexId middle(VertexId::Kind::Edge, mesh.half_edge(side.node, side.side) >> 1);
    halves[{ends.first, middle}] = halves[{middle, ends.second}] = side;
  }
  for (const auto& [ends, side] : sides) {
    const VertexId middle(VertexId::Kind::Edge, mesh.half_edge(side.node, side.side) >> 1);
    std::vector<SideLink> expected;
    if (sides.count({ends.second, ends.first})) {
      expected = {sides[{ends.second, ends.first}]};
    } else {
      if (sides.count({middle, ends.first})) expected.push_back(sides[{middle, ends.first}]);
      if (sides.count({ends.second, middle})) expected.push_back(sides[{ends.second, middle}]);
      if (expected.empty() && halves.count({ends.second, ends.first})) expected = {halves[{ends.second, ends.first}]};
    }
    EXPECT_EQ(mesh.leaf_neighbours(side.node, side.side), expected);
  }
  return true;
}

std::vector<int> active_of_level(const HybridMesh& mesh, int level) {
  std::vector<int> result;
  for (int n = 0; n < mesh.node_count(); ++n)
    if (mesh.is_active(n) && mesh.level(n) == level && !mesh.is_root(n)) result.push_back(n);
  return result;
}

TEST(Operations, ACubeReplacesAQuad) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(2);
  const int node = active_of_level(mesh, 2)[7];
  const std::size_t before = mesh.level_mesh(2).face_count();
  ASSERT_EQ(mesh.apply(cube_on(mesh, node)), "");
  EXPECT_TRUE(sound(mesh));
  EXPECT_EQ(mesh.removed_by(node), 0);
  EXPECT_FALSE(mesh.is_active(node));
  for (int s = 0; s < 4; ++s) {
    const SideLink link = mesh.removed_neighbour(node, s);
    ASSERT_TRUE(link.valid());
    EXPECT_EQ(mesh.inserted_by(link.node), 0);
    EXPECT_EQ(mesh.half_edge(link.node, link.side), mesh.half_edge(node, s));
  }
  EXPECT_EQ(mesh.level_mesh(2, LevelKind::M).face_count(), before);
  const SoupTopology topology = soup_topology(mesh.level_mesh(2));
  EXPECT_EQ(topology.faces, static_cast<int>(before) + 4);
  EXPECT_TRUE(topology.manifold);
  EXPECT_EQ(topology.euler, 2);
  EXPECT_EQ(mesh.level_mesh(1).face_count(), 24u);
  // Finer levels go through the operation.
  mesh.refine_uniform(4);
  EXPECT_TRUE(sound(mesh));
  EXPECT_EQ(mesh.level_mesh(4).face_count(), 16 * (before + 4));
  EXPECT_EQ(mesh.level_mesh(4, LevelKind::M).face_count(), 16 * (before + 4));
  EXPECT_TRUE(check_links_by_corners(mesh));
}

TEST(Operations, ABoundaryOpens) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(1);
  ASSERT_EQ(mesh.apply(opening(mesh, {active_of_level(mesh, 1)[3]})), "");
  EXPECT_TRUE(sound(mesh));
  mesh.refine_uniform(3);
  EXPECT_TRUE(sound(mesh));
  for (int j : {1, 2, 3}) {
    const SoupTopology topology = soup_topology(mesh.level_mesh(j));
    EXPECT_TRUE(topology.manifold);
    EXPECT_EQ(topology.euler, 1);
    EXPECT_EQ(topology.boundary_loops, 1);
    EXPECT_EQ(topology.boundary_edges, 4 << (j - 1));
  }
  EXPECT_EQ(soup_topology(mesh.level_mesh(1, LevelKind::M)).euler, 2);
}

TEST(Operations, TwoHolesAreConnected) {
  for (int turn = 0; turn < 4; ++turn) {
    HybridMesh mesh = cube();
    mesh.refine_uniform(2);
    const int a = mesh.first_child(mesh.first_child(0)) + 2, b = mesh.first_child(mesh.first_child(1)) + 2;
    ASSERT_EQ(mesh.apply(tube_between(mesh, a, b, turn)), "");
    EXPECT_TRUE(sound(mesh));
    EXPECT_EQ(mesh.leaf_counts().euler, 0);
    const SoupTopology topology = soup_topology(mesh.level_mesh(2));
    EXPECT_TRUE(topology.manifold);
    EXPECT_EQ(topology.euler, 0);
    EXPECT_EQ(soup_topology(mesh.level_mesh(1)).euler, 2);
    mesh.refine_balanced(mesh.roots().back());
    EXPECT_TRUE(sound(mesh));
    EXPECT_TRUE(check_links_by_corners(mesh));
  }
}

TEST(Operations, AHoleOfAnEarlierOperationIsFilled) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(1);
  const int node = active_of_level(mesh, 1)[9];
  ASSERT_EQ(mesh.apply(opening(mesh, {node})), "");
  Repatch fill = cube_on(mesh, node);
  fill.removed.clear();
  ASSERT_EQ(mesh.apply(fill), "");
  EXPECT_TRUE(sound(mesh));
  EXPECT_EQ(mesh.leaf_counts().euler, 2);
  EXPECT_EQ(mesh.operation(1).depends, std::vector<int>{0});
  EXPECT_NE(mesh.set_enabled({false, true}), "");
  EXPECT_EQ(mesh.set_enabled({true, false}), "");
  EXPECT_EQ(mesh.leaf_counts().euler, 1);
  EXPECT_TRUE(sound(mesh));
}

TEST(Operations, OperationsStandOnOperations) {
  // A tower that branches: a cube on the top of a cube, at finer and finer levels.
  HybridMesh mesh = grid(2, 2);
  mesh.refine_uniform(1);
  int node = mesh.first_child(0) + 2;
  for (int level = 1; level <= 5; ++level) {
    ASSERT_EQ(mesh.apply(cube_on(mesh, node)), "");
    mesh.balance();
    EXPECT_TRUE(sound(mesh));
    const int top = mesh.operation(level - 1).roots[4];
    mesh.refine_balanced(top);
    node = mesh.first_child(top) + level % 4;
    EXPECT_EQ(mesh.operation(level - 1).depends, level > 1 ? std::vector<int>{level - 2} : std::vector<int>{});
    EXPECT_TRUE(sound(mesh));
  }
  EXPECT_TRUE(check_links_by_corners(mesh));
  EXPECT_EQ(soup_topology(mesh.final_mesh()).euler, 1);
  for (int count = 4; count >= 0; --count) {
    std::vector<bool> enabled(5, false);
    std::fill(enabled.begin(), enabled.begin() + count, true);
    EXPECT_EQ(mesh.set_enabled(enabled), "");
    mesh.balance();
    EXPECT_TRUE(sound(mesh));
    const SoupTopology topology = soup_topology(mesh.final_mesh());
    EXPECT_EQ(topology.euler, 1);
    EXPECT_TRUE(topology.manifold);
  }
}

TEST(Operations, DisabledOperationsLeaveTheRegularMesh) {
  HybridMesh regular = torus(3, 3);
  regular.refine_uniform(3);
  HybridMesh mesh = torus(3, 3);
  mesh.refine_uniform(2);
  ASSERT_EQ(mesh.apply(cube_on(mesh, mesh.first_child(mesh.first_child(4)) + 1)), "");
  ASSERT_EQ(mesh.apply(cube_on(mesh, mesh.first_child(mesh.first_child(4)) + 3)), "");
  mesh.refine_uniform(3);
  const QuadMesh with = mesh.level_mesh(3);
  ASSERT_EQ(mesh.set_enabled({false, false}), "");
  mesh.refine_uniform(3);
  EXPECT_EQ(mesh.level_mesh(3).indices, regular.level_mesh(3).indices);
  EXPECT_TRUE(sound(mesh));
  ASSERT_EQ(mesh.set_enabled({true, true}), "");
  EXPECT_EQ(mesh.level_mesh(3).indices, with.indices);
  EXPECT_TRUE(sound(mesh));
}

TEST(Operations, WhatWouldBreakAnInvariantIsRefusedAndChangesNothing) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(2);
  const int deep = mesh.first_child(mesh.first_child(2));
  ASSERT_EQ(mesh.apply(cube_on(mesh, deep)), "");
  const QuadMesh before = mesh.final_mesh();
  const int nodes = mesh.node_count();
  const auto refused = [&](const Repatch& repatch) {
    const std::string reason = mesh.apply(repatch);
    EXPECT_TRUE(sound(mesh));
    EXPECT_EQ(mesh.node_count(), nodes);
    EXPECT_EQ(mesh.final_mesh().indices, before.indices);
    return reason;
  };
  Repatch repatch;
  EXPECT_NE(refused(repatch), "");
  EXPECT_NE(refused(cube_on(mesh, 0)), "");                            // a base quad
  EXPECT_NE(refused(cube_on(mesh, mesh.operation(0).roots[0])), "");   // an inserted root
  EXPECT_NE(refused(cube_on(mesh, deep)), "");                         // removed before
  EXPECT_NE(refused(cube_on(mesh, mesh.parent(deep))), "");            // a finer operation lies below
  EXPECT_NE(refused(opening(mesh, {mesh.first_child(4), deep})), "");  // two levels
  const int a = mesh.first_child(mesh.first_child(5));
  EXPECT_NE(refused(opening(mesh, {a, a})), "");      // twice the same
  EXPECT_NE(refused(opening(mesh, {a, a + 2})), "");  // leaves two fans at a vertex
  EXPECT_NE(refused(opening(mesh, {mesh.node_count()})), "");
  repatch = cube_on(mesh, a);
  repatch.quads.pop_back();
  repatch.quads.push_back({-1, -4, -3, -2});  // turned over
  EXPECT_NE(refused(repatch), "");
  repatch = cube_on(mesh, a);
  repatch.new_vertices = 5;
  EXPECT_NE(refused(repatch), "");
  repatch = cube_on(mesh, a);
  repatch.boundary[0] = VertexId(VertexId::Kind::Free, 100000);
  EXPECT_NE(refused(repatch), "");
  repatch = cube_on(mesh, a);
  repatch.quads[4][0] = 9;
  EXPECT_NE(refused(repatch), "");
  // A quad that stays cannot be covered: its place is taken.
  repatch = cube_on(mesh, a);
  repatch.removed.clear();
  EXPECT_NE(refused(repatch), "");
  ASSERT_EQ(mesh.set_enabled({false}), "");
  EXPECT_NE(mesh.apply(cube_on(mesh, a)), "");  // with an earlier one switched off
}

// Any sequence of refinements and operations keeps every invariant, and parts put together again give the same hierarchy.
TEST(Operations, RandomSequencesKeepEveryInvariant) {
  // HYBRID_MESH_SEQUENCES: how many a base, for a longer run.
  const char* given = std::getenv("HYBRID_MESH_SEQUENCES");
  const unsigned sequences = given ? static_cast<unsigned>(std::atoi(given)) : 25;
  int applied = 0, refused = 0, compared = 0;
  for (Base& base : bases())
    for (unsigned seed = 0; seed < sequences; ++seed) {
      SCOPED_TRACE(base.name + " " + std::to_string(seed));
      HybridMesh mesh = base.mesh;
      std::mt19937 random(seed);
      mesh.refine_uniform(1);
      for (int step = 0; step < 12; ++step) {
        const int level = 1 + static_cast<int>(random() % 3);
        const std::vector<int> candidates = active_of_level(mesh, level);
        const int choice = static_cast<int>(random() % 6);
        if (choice < 3 || candidates.empty()) {
          const std::vector<int> leaves = mesh.leaves();
          const int leaf = leaves[random() % leaves.size()];
          if (mesh.level(leaf) < 5) mesh.refine_balanced(leaf);
        } else {
          const auto any = [&] { return candidates[random() % candidates.size()]; };
          const int nodes = mesh.node_count();
          const auto counts = mesh.leaf_counts();
          const Repatch repatch = choice == 3   ? cube_on(mesh, any())
                                  : choice == 4 ? opening(mesh, {any()})
                                                : tube_between(mesh, any(), any(), static_cast<int>(random() % 4));
          const std::string reason = mesh.apply(repatch);
          (reason.empty() ? applied : refused) += 1;
          if (!reason.empty()) {
            EXPECT_EQ(mesh.node_count(), nodes);
            EXPECT_EQ(mesh.leaf_counts().vertices, counts.vertices);
          }
          mesh.balance();
        }
        ASSERT_TRUE(sound(mesh));
        compared += check_links_by_corners(mesh);
        EXPECT_EQ(static_cast<std::int64_t>(mesh.final_mesh(FaceClosure::Quads).vertex_count()), mesh.closed_vertex_count());
      }
      const HybridMesh canonical = mesh.canonical();
      ASSERT_TRUE(sound(canonical));
      EXPECT_EQ(canonical.node_count(), mesh.node_count());
      EXPECT_EQ(canonical.leaf_counts().vertices, mesh.leaf_counts().vertices);
      const HybridMesh again = put_together(take_apart(mesh));
      ASSERT_TRUE(sound(again));
      EXPECT_EQ(again.final_mesh().indices, canonical.final_mesh().indices);
      // Off and on again, as far as the dependencies allow.
      std::vector<bool> enabled(mesh.operation_count());
      for (int o = 0; o < mesh.operation_count(); ++o) {
        enabled[o] = random() % 2;
        for (int d : mesh.operation(o).depends) enabled[o] = enabled[o] && enabled[d];
      }
      if (mesh.set_enabled(enabled).empty()) {
        mesh.balance();
        ASSERT_TRUE(sound(mesh));
        ASSERT_TRUE(sound(put_together(take_apart(mesh))));
      }
    }
  RecordProperty("applied", applied);
  EXPECT_GT(applied, 100);
  EXPECT_GT(refused, 10);
  EXPECT_GT(compared, 300);
}

}  // namespace
}  // namespace hybrid_mesh
