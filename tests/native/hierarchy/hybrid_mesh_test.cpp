// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/hybrid_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "hierarchy/bases.h"

namespace hybrid_mesh {
namespace {

testing::AssertionResult sound(const HybridMesh& mesh) {
  const auto defects = find_defects(mesh);
  if (defects.empty()) return testing::AssertionSuccess();
  return testing::AssertionFailure() << defects.size() << " defects, first: " << defects[0];
}

// Every neighbour query against what the corners of all leaves say, for meshes without two edges between the same vertices.
void check_neighbours_by_corners(const HybridMesh& mesh) {
  std::map<std::pair<VertexId, VertexId>, SideLink> sides;
  const std::vector<int> leaves = mesh.leaves();
  for (int n : leaves)
    for (int s = 0; s < 4; ++s) ASSERT_TRUE((sides.try_emplace({mesh.corner(n, s), mesh.corner(n, (s + 1) % 4)}, SideLink{n, s}).second));
  for (int n : leaves)
    for (int s = 0; s < 4; ++s) {
      const VertexId a = mesh.corner(n, s), b = mesh.corner(n, (s + 1) % 4), middle(VertexId::Kind::Edge, mesh.half_edge(n, s) >> 1);
      std::vector<SideLink> expected;
      if (sides.count({b, a})) {
        expected.push_back(sides[{b, a}]);
      } else if (sides.count({middle, a}) || sides.count({b, middle})) {
        if (sides.count({middle, a})) expected.push_back(sides[{middle, a}]);
        if (sides.count({b, middle})) expected.push_back(sides[{b, middle}]);
        EXPECT_TRUE(mesh.has_finer_neighbour(n, s));
      } else {
        for (int m : leaves)  // coarser: one end is the middle of its side
          for (int t = 0; t < 4; ++t) {
            const VertexId c = mesh.corner(m, t), d = mesh.corner(m, (t + 1) % 4), between(VertexId::Kind::Edge, mesh.half_edge(m, t) >> 1);
            if ((b == c && a == between) || (b == between && a == d)) expected.push_back({m, t});
          }
        EXPECT_LE(expected.size(), 1u);
      }
      EXPECT_EQ(mesh.leaf_neighbours(n, s), expected);
      const SideLink direct = mesh.neighbour(n, s);
      if (expected.empty()) {
        EXPECT_FALSE(direct.valid());
      } else if (!mesh.has_finer_neighbour(n, s)) {
        EXPECT_EQ(direct, expected[0]);
      }
    }
  // Leaves around corners: those that have the vertex as a corner or in the middle of a side.
  for (int n : leaves)
    for (int c = 0; c < 4; ++c) {
      const VertexId v = mesh.corner(n, c);
      std::set<int> expected;
      for (int m : leaves)
        for (int t = 0; t < 4; ++t)
          if (mesh.corner(m, t) == v || VertexId(VertexId::Kind::Edge, mesh.half_edge(m, t) >> 1) == v) expected.insert(m);
      const std::vector<int> found = mesh.leaves_at_corner(n, c);
      EXPECT_EQ(std::set<int>(found.begin(), found.end()), expected);
      EXPECT_EQ(found.size(), expected.size());
    }
}

TEST(HybridMesh, BasesAreSound) {
  for (const Base& base : bases()) {
    SCOPED_TRACE(base.name);
    EXPECT_TRUE(sound(base.mesh));
    EXPECT_EQ(base.mesh.leaf_counts().euler, base.euler);
  }
}

TEST(HybridMesh, BadBasesAreRefused) {
  const auto refused = [](int vertices, std::vector<std::array<int, 4>> quads) {
    try {
      HybridMesh::from_base(vertices, quads);
    } catch (const Error& error) {
      return error.code() == ErrorCode::InvalidInput;
    }
    return false;
  };
  EXPECT_TRUE(refused(0, {}));
  EXPECT_TRUE(refused(4, {{0, 1, 2, 4}}));
  EXPECT_TRUE(refused(4, {{0, 1, 2, -1}}));
  EXPECT_TRUE(refused(5, {{0, 1, 2, 3}}));
  EXPECT_TRUE(refused(6, {{0, 1, 2, 3}, {0, 1, 4, 5}}));  // along one edge in one direction
  EXPECT_TRUE(refused(7, {{0, 1, 2, 3}, {0, 4, 5, 6}}));  // joined in a vertex alone
  EXPECT_TRUE(refused(4, {{0, 1, 2, 3}, {0, 1, 2, 3}}));
  std::vector<std::array<SideLink, 4>> one_way(2);
  one_way[0][0] = {1, 2};
  EXPECT_THROW(HybridMesh::from_base(6, {{0, 1, 2, 3}, {4, 5, 1, 0}}, one_way), Error);
}

TEST(HybridMesh, UniformLevelsHaveTheTopologyOfTheBase) {
  for (Base& base : bases()) {
    SCOPED_TRACE(base.name);
    base.mesh.refine_uniform(4);
    EXPECT_TRUE(sound(base.mesh));
    EXPECT_TRUE(base.mesh.conforming());
    for (int j = 0; j <= 4; ++j) {
      const QuadMesh level = base.mesh.level_mesh(j);
      EXPECT_EQ(level.face_count(), static_cast<std::size_t>(base.mesh.base_count()) << (2 * j));
      for (int n : level.node) EXPECT_EQ(base.mesh.level(n), j);
      if (!base.simple && j < 2) continue;  // a soup cannot tell multiple edges apart
      const SoupTopology topology = soup_topology(level);
      EXPECT_TRUE(topology.manifold) << j;
      EXPECT_EQ(topology.euler, base.euler);
      EXPECT_EQ(topology.boundary_loops, base.boundary_loops);
      EXPECT_EQ(topology.not_quads, 0);
    }
    EXPECT_EQ(base.mesh.final_mesh().indices, base.mesh.level_mesh(4).indices);
    EXPECT_EQ(static_cast<std::int64_t>(base.mesh.final_mesh().vertex_count()), base.mesh.closed_vertex_count());
  }
}

TEST(HybridMesh, BalancedRefinementKeepsEveryInvariant) {
  for (Base& base : bases())
    for (unsigned seed = 0; seed < 6; ++seed) {
      SCOPED_TRACE(base.name);
      HybridMesh mesh = base.mesh;
      std::mt19937 random(seed);
      for (int step = 0; step < 25; ++step) {
        const std::vector<int> leaves = mesh.leaves();
        // Half of the steps dig where the last one did.
        const int leaf = step % 2 ? leaves[random() % leaves.size()] : leaves[leaves.size() / 3];
        if (mesh.level(leaf) > 8) continue;
        std::vector<int> refined;
        const std::int64_t before = mesh.leaf_counts().faces;
        mesh.refine_balanced(leaf, &refined);
        EXPECT_FALSE(mesh.is_leaf(leaf));
        EXPECT_EQ(mesh.leaf_counts().faces, before + 3 * static_cast<std::int64_t>(refined.size()));
        EXPECT_EQ(mesh.leaf_counts().euler, base.euler);
        ASSERT_TRUE(sound(mesh));
      }
      if (base.simple) check_neighbours_by_corners(mesh);
      HybridMesh again = mesh;
      std::vector<int> refined;
      again.balance(&refined);
      EXPECT_TRUE(refined.empty());
    }
}

TEST(HybridMesh, BalanceRepairsWhatRefineLeaves) {
  for (Base& base : bases()) {
    SCOPED_TRACE(base.name);
    std::mt19937 random(7);
    for (int step = 0; step < 20; ++step) {
      const std::vector<int> leaves = base.mesh.leaves();
      const int leaf = leaves[random() % leaves.size()];
      if (base.mesh.level(leaf) < 7) base.mesh.refine(leaf);
    }
    base.mesh.balance();
    EXPECT_TRUE(sound(base.mesh));
  }
}

TEST(HybridMesh, ClosuresAreConformingManifolds) {
  for (Base& base : bases())
    for (unsigned seed = 0; seed < 4; ++seed) {
      SCOPED_TRACE(base.name);
      HybridMesh mesh = base.mesh;
      mesh.refine_uniform(2);
      std::mt19937 random(seed);
      for (int step = 0; step < 12; ++step) {
        const std::vector<int> leaves = mesh.leaves();
        mesh.refine_balanced(leaves[step % 3 ? leaves.size() / 2 : random() % leaves.size()]);
      }
      for (FaceClosure closure : {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles}) {
        const QuadMesh final_mesh = mesh.final_mesh(closure);
        const SoupTopology topology = soup_topology(final_mesh);
        EXPECT_TRUE(topology.manifold);
        EXPECT_EQ(topology.euler, base.euler);
        EXPECT_EQ(topology.boundary_loops, base.boundary_loops);
        if (closure == FaceClosure::Quads) {
          EXPECT_EQ(topology.not_quads, 0);
          EXPECT_EQ(topology.vertices, mesh.closed_vertex_count());
        } else {
          EXPECT_EQ(topology.vertices, mesh.leaf_counts().vertices);
        }
        for (std::size_t f = 0; f < final_mesh.face_count(); ++f)
          EXPECT_LE(final_mesh.offsets[f + 1] - final_mesh.offsets[f], closure == FaceClosure::Transition ? 6 : 4);
        // N-gons start at a hanging node.
        for (std::size_t f = 0; f < final_mesh.face_count(); ++f) {
          const VertexId first = final_mesh.vertex[final_mesh.indices[final_mesh.offsets[f]]];
          for (int c = 0; c < 4 && final_mesh.offsets[f + 1] - final_mesh.offsets[f] > 4; ++c)
            EXPECT_TRUE(first != mesh.corner(final_mesh.node[f], c));
        }
        for (int j = 2; j <= mesh.depth(); ++j) {
          const SoupTopology level = soup_topology(mesh.level_mesh(j, LevelKind::N, closure));
          EXPECT_TRUE(level.manifold);
          EXPECT_EQ(level.euler, base.euler);
        }
      }
    }
}

TEST(HybridMesh, NumberingDependsOnTheStructureAlone) {
  HybridMesh a = cube(), b = cube();
  for (int q : {0, 3, 5}) a.refine(q);
  for (int q : {5, 0, 3}) b.refine(q);
  a.refine(a.first_child(3) + 2), a.refine(a.first_child(0) + 1);
  b.refine(b.first_child(0) + 1), b.refine(b.first_child(3) + 2);
  EXPECT_EQ(a.final_mesh().indices, b.final_mesh().indices);
}

TEST(HybridMesh, LocationsAgreeFromAllSides) {
  // A torus of maps onto a plane, modulo its period: every face must find its corners at the same place.
  HybridMesh mesh = grid(3, 2);
  for (int q = 0; q < 6; ++q) {
    const double x = q % 3, y = q / 3;
    mesh.set_map(q, make_map(5, 0.2, q, [&](double u, double v) { return Vec3(x + u, y + v, 0); }));
  }
  mesh.refine_uniform(2);
  std::mt19937 random(3);
  for (int step = 0; step < 15; ++step) {
    const std::vector<int> leaves = mesh.leaves();
    mesh.refine_balanced(leaves[random() % leaves.size()]);
  }
  // A node below takes over with a map of its own.
  const int inner = mesh.first_child(1) + 2;
  mesh.set_map(inner, make_map(3, 0.2, 9, [&](double u, double v) { return Vec3(1.5 + 0.5 * u, 0.5 + 0.5 * v, 0); }));
  EXPECT_EQ(mesh.map_owner(mesh.first_child(inner)), inner);
  for (const QuadMesh& m : {mesh.final_mesh(), mesh.level_mesh(2)}) {
    for (std::size_t i = 0; i < m.vertex_count(); ++i) {
      EXPECT_NEAR((mesh.sample(m.vertex[i]).position - m.points[i]).norm(), 0, 1e-12);
      EXPECT_NEAR((mesh.sample(m.location[i]).position - m.points[i]).norm(), 0, 0);
    }
    for (std::size_t f = 0; f < m.face_count(); ++f) {
      const int n = m.node[f];
      const HybridMesh::Square square = mesh.square_in(n, m.root[f]);
      Vec3 low(m.root[f] % 3 + square.u, m.root[f] / 3 + square.v, 0);
      for (auto k = m.offsets[f]; k < m.offsets[f + 1]; ++k) {
        const Vec3 d = m.points[m.indices[k]] - low;
        EXPECT_GE(d.head<2>().minCoeff(), -1e-12);
        EXPECT_LE(d.head<2>().maxCoeff(), square.width + 1e-12);
      }
    }
  }
  mesh.drop_maps();
  EXPECT_FALSE(mesh.has_maps());
}

TEST(HybridMesh, KeptPositionsSurviveRefinement) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(2);
  QuadMesh level = mesh.level_mesh(1);
  for (std::size_t i = 0; i < level.points.size(); ++i) level.points[i] = Vec3(static_cast<double>(i), 1, 2);
  mesh.set_level_positions(1, level);
  mesh.refine_balanced(mesh.leaves()[5]);
  EXPECT_EQ(mesh.level_mesh(1).points, level.points);
  EXPECT_EQ(mesh.level_mesh(2).points[0], Vec3::Zero());
  QuadMesh last = mesh.final_mesh();
  for (std::size_t i = 0; i < last.points.size(); ++i) last.points[i] = Vec3(0, static_cast<double>(i), 2);
  mesh.set_final_positions(last);
  EXPECT_EQ(mesh.final_mesh().points, last.points);
}

TEST(HybridMesh, TooManyLevelsAreRefused) {
  HybridMesh mesh = grid(1, 1);
  int n = 0;
  for (int j = 0; j < HybridMesh::max_level; ++j) n = mesh.refine(n);
  EXPECT_THROW(mesh.refine(n), Error);
  EXPECT_THROW(mesh.refine_uniform(HybridMesh::max_level + 1), Error);
}

}  // namespace
}  // namespace hybrid_mesh
