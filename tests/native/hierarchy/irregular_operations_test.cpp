// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/irregular_operations.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "base/error.h"
#include "hierarchy/archive.h"
#include "hierarchy/bases.h"
#include "hierarchy/operation_checks.h"
#include "layout/disks/disk_layout.h"

namespace hybrid_mesh {
namespace {

// A block of quads of a level of a refined grid of one quad: columns [x0, x1), rows [y0, y1).
std::vector<int> block(const HybridMesh& mesh, int level, int x0, int y0, int x1, int y1) {
  std::vector<int> result;
  for (int n : active_of_level(mesh, level)) {
    const HybridMesh::Square square = mesh.square_in(n, mesh.root(n));
    const double x = square.u / square.width, y = square.v / square.width;
    if (mesh.root(n) == 0 && x >= x0 && x < x1 && y >= y0 && y < y1) result.push_back(n);
  }
  return result;
}

HybridMesh square_grid(int level) {
  HybridMesh mesh = grid(1, 1);
  mesh.refine_uniform(level);
  return mesh;
}

// Quads around every vertex of a level, and whether it lies on the boundary.
std::map<VertexId, std::pair<int, bool>> valences(const HybridMesh& mesh, int level) {
  std::map<VertexId, std::pair<int, bool>> result;
  for (int n = 0; n < mesh.node_count(); ++n)
    for (int s = 0; s < 4 && mesh.is_active(n) && mesh.level(n) == level; ++s) {
      result[mesh.corner(n, s)].first += 1;
      if (!mesh.neighbour(n, s).valid()) result[mesh.corner(n, s)].second = result[mesh.corner(n, (s + 1) % 4)].second = true;
    }
  return result;
}

TEST(IrregularOperations, RegionsAreDisks) {
  const HybridMesh mesh = square_grid(3);
  const DiskRegion region = find_disk_region(mesh, block(mesh, 3, 2, 2, 4, 5));
  EXPECT_EQ(region.reason, "");
  EXPECT_EQ(region.boundary.size(), 10u);
  EXPECT_EQ(region.inner.size(), 2u);
  const std::set<VertexId> corners(region.corners.begin(), region.corners.end());
  EXPECT_EQ(corners.size(), 10u);
  for (std::size_t k = 0; k < 10; ++k) EXPECT_EQ(mesh.to(region.boundary[k]), region.corners[(k + 1) % 10]);
  std::vector<int> wished = regular_quads(region);
  EXPECT_EQ(std::count(wished.begin(), wished.end(), 1), 4);
  EXPECT_EQ(std::count(wished.begin(), wished.end(), 2), 6);
  // The boundary begins where it is told to.
  EXPECT_EQ(find_disk_region(mesh, region.nodes, region.boundary[3]).corners[0], region.corners[3]);
  EXPECT_NE(find_disk_region(mesh, region.nodes, region.boundary[3] ^ 1).reason, "");

  const auto reason = [&](std::vector<int> nodes) { return find_disk_region(mesh, nodes).reason; };
  std::vector<int> two = block(mesh, 3, 0, 0, 1, 1), ring = block(mesh, 3, 1, 1, 4, 4);
  const std::vector<int> middle = block(mesh, 3, 2, 2, 3, 3), far = block(mesh, 3, 5, 5, 6, 6), diagonal = block(mesh, 3, 1, 1, 2, 2);
  ring.erase(std::find(ring.begin(), ring.end(), middle[0]));
  EXPECT_NE(reason({}), "");
  EXPECT_NE(reason(ring), "");
  EXPECT_NE(reason({two[0], far[0]}), "");
  EXPECT_NE(reason({two[0], diagonal[0]}), "");
  EXPECT_NE(reason({two[0], two[0]}), "");
  EXPECT_NE(reason({two[0], mesh.parent(two[0])}), "");
  EXPECT_NE(reason({0}), "");
  EXPECT_NE(reason({-1}), "");
  EXPECT_NE(reason({mesh.node_count()}), "");
}

TEST(IrregularOperations, TowersGrowOnAnyDisk) {
  struct Case {
    int x1, y1, count;
  };
  for (const Case& c : {Case{3, 3, 1}, Case{3, 3, 5}, Case{4, 3, 1}, Case{5, 4, 3}, Case{6, 6, 2}}) {
    HybridMesh mesh = square_grid(3);
    const std::vector<int> nodes = block(mesh, 3, 2, 2, c.x1, c.y1);
    const int sides = static_cast<int>(find_disk_region(mesh, nodes).boundary.size());
    const OperationDraft draft = add_cubes(mesh, nodes, c.count);
    ASSERT_EQ(draft.reason, "");
    ASSERT_EQ(mesh.apply(draft.repatch), "");
    EXPECT_EQ(mesh.operation(0).roots.size(), nodes.size() + static_cast<std::size_t>(c.count * sides));
    mesh.balance();
    EXPECT_TRUE(sound(mesh));
    EXPECT_EQ(mesh.leaf_counts().euler, 1);
    const SoupTopology topology = soup_topology(mesh.level_mesh(3));
    EXPECT_TRUE(topology.manifold);
    EXPECT_EQ(topology.boundary_edges, 32);
    // Only the corners of the region and of its copy are irregular.
    int irregular = 0;
    for (const auto& [vertex, at] : valences(mesh, 3)) irregular += at.first != (at.second ? 2 : 4);
    EXPECT_EQ(irregular, 4 + 4 + 4);  // those of the square itself among them
  }
}

TEST(IrregularOperations, TubesJoinBoundariesOfAnySizes) {
  struct Case {
    int width_a, height_a, width_b, height_b;
  };
  for (const Case& c : {Case{1, 1, 1, 1}, Case{1, 1, 2, 1}, Case{2, 1, 1, 1}, Case{3, 2, 3, 2}, Case{1, 1, 5, 5}, Case{5, 4, 1, 1}, Case{6, 1, 2, 2},
                        Case{14, 5, 1, 1}})
    for (int turn : {0, 1, -1, 3, 100}) {
      SCOPED_TRACE(testing::Message() << c.width_a << "x" << c.height_a << " and " << c.width_b << "x" << c.height_b << ", turn " << turn);
      HybridMesh mesh = square_grid(4);
      const OperationDraft draft =
          connect(mesh, block(mesh, 4, 1, 1, 1 + c.width_a, 1 + c.height_a), block(mesh, 4, 1, 8, 1 + c.width_b, 8 + c.height_b), turn);
      ASSERT_EQ(draft.reason, "");
      ASSERT_EQ(mesh.apply(draft.repatch), "");
      EXPECT_TRUE(sound(mesh));
      EXPECT_EQ(mesh.leaf_counts().euler, -1);
      for (const auto& [vertex, at] : valences(mesh, 4)) {
        if (at.second) continue;
        EXPECT_GE(at.first, 3);
        EXPECT_LE(at.first, 6);
      }
    }
  // Equal boundaries: side 0 of one faces the side asked for.
  HybridMesh mesh = square_grid(3);
  const std::vector<int> a = block(mesh, 3, 1, 1, 2, 2), b = block(mesh, 3, 5, 5, 6, 6);
  for (int turn = 0; turn < 4; ++turn) {
    HybridMesh joined = mesh;
    ASSERT_EQ(joined.apply(connect(mesh, a, b, turn).repatch), "");
    const SideLink link = joined.removed_neighbour(a[0], 0);
    EXPECT_EQ(joined.half_edge(link.node, (link.side + 2) % 4), find_disk_region(mesh, b).boundary[turn]);
  }
}

TEST(IrregularOperations, RegionsNextToEachOtherAreJoinedByTwoRings) {
  HybridMesh mesh = square_grid(3);
  // One quad between them: straight tubes of some turns would double its edges.
  for (int turn = 0; turn < 4; ++turn) {
    HybridMesh joined = mesh;
    const OperationDraft draft = connect(mesh, block(mesh, 3, 2, 2, 3, 3), block(mesh, 3, 4, 2, 5, 3), turn);
    ASSERT_EQ(draft.reason, "");
    ASSERT_EQ(joined.apply(draft.repatch), "");
    EXPECT_TRUE(sound(joined));
  }
  EXPECT_NE(connect(mesh, block(mesh, 3, 2, 2, 3, 3), block(mesh, 3, 3, 2, 4, 3), 0).reason, "");
  EXPECT_NE(connect(mesh, block(mesh, 3, 2, 2, 3, 3), block(mesh, 3, 2, 2, 3, 3), 0).reason, "");
}

TEST(IrregularOperations, LayoutsAreGluedOrRefusedInWords) {
  HybridMesh mesh = square_grid(3);
  const std::vector<int> nodes = block(mesh, 3, 2, 2, 4, 4);
  const std::vector<std::array<int, 4>> star = {{0, 1, 2, 8}, {2, 3, 4, 8}, {4, 5, 6, 8}, {6, 7, 0, 8}};
  const auto reason = [&](std::vector<std::array<int, 4>> quads) { return free_layout(mesh, nodes, quads).reason; };
  EXPECT_NE(reason({}), "");
  EXPECT_NE(reason({{0, 1, 2, 8}, {2, 3, 4, 8}, {4, 5, 6, 8}}), "");
  EXPECT_NE(reason({{0, 1, 2, 8}, {2, 3, 4, 8}, {4, 5, 6, 8}, {6, 7, 0, 8}, {0, 1, 2, 9}}), "");
  EXPECT_NE(reason({{0, 1, 2, 8}, {2, 3, 4, 8}, {4, 5, 6, 8}, {6, 7, 0, 9}}), "");
  EXPECT_NE(reason({{0, 1, 2, -1}}), "");
  EXPECT_NE(reason({{0, 1, 2, 1000}}), "");
  EXPECT_NE(reason({{8, 2, 1, 0}, {8, 4, 3, 2}, {8, 6, 5, 4}, {8, 0, 7, 6}}), "");  // turned over
  for (HalfEdge start : find_disk_region(mesh, nodes).boundary) {
    HybridMesh changed = mesh;
    const OperationDraft draft = free_layout(mesh, nodes, star, start);
    ASSERT_EQ(draft.reason, "");
    ASSERT_EQ(changed.apply(draft.repatch), "");
    EXPECT_TRUE(sound(changed));
    EXPECT_EQ(changed.half_edge(changed.operation(0).roots[0], 0), start);
    EXPECT_EQ(changed.leaf_counts().euler, 1);
  }
}

// --- queries and choices where little is left ----------------------------------------------------------------------------------------------------

TEST(IrregularOperations, AHoleInARefinedNeighbourIsABoundary) {
  HybridMesh mesh = square_grid(1);
  const int left = mesh.first_child(0), right = left + 1;
  const int child = mesh.refine(right);
  ASSERT_EQ(mesh.apply(open_boundary(mesh, {child, child + 3}).repatch), "");
  EXPECT_EQ(mesh.neighbour(left, 1).node, right);
  EXPECT_TRUE(mesh.leaf_neighbours(left, 1).empty());
  EXPECT_FALSE(mesh.has_finer_neighbour(left, 1));
  EXPECT_TRUE(sound(mesh));
  mesh.refine(left);
  EXPECT_TRUE(sound(mesh));
}

TEST(IrregularOperations, CountsHoldWhereACoarseLeafMeetsAnEndOfAHole) {
  // Of the right half of the square, next to the coarse leaf on the left, only the lowest eighth of the side is left.
  HybridMesh mesh = square_grid(1);
  const int left = mesh.first_child(0), child = mesh.refine(left + 1), grandchild = mesh.refine(child);
  ASSERT_EQ(mesh.apply(open_boundary(mesh, {child + 3}).repatch), "");
  ASSERT_EQ(mesh.apply(open_boundary(mesh, {grandchild + 3}).repatch), "");
  EXPECT_TRUE(sound_but_for_balance(mesh));
  EXPECT_TRUE(soup_topology(mesh.final_mesh(FaceClosure::Transition)).manifold);
  EXPECT_EQ(static_cast<std::int64_t>(mesh.final_mesh(FaceClosure::Quads).vertex_count()), mesh.closed_vertex_count());
  mesh.refine(left);
  EXPECT_TRUE(sound_but_for_balance(mesh));
}

TEST(IrregularOperations, WhatIsLeftMustBeAManifoldWhereARefinedQuadHasLostAllItsChildren) {
  HybridMesh mesh = square_grid(1);
  const int first = mesh.first_child(0);
  const auto children = [&](int n) {
    const int child = mesh.refine(n);
    return std::vector<int>{child, child + 1, child + 2, child + 3};
  };
  const std::vector<int> a = children(first + 1), b = children(first + 3);
  ASSERT_EQ(mesh.apply(open_boundary(mesh, a).repatch), "");
  // The two quads that are left would meet in a vertex alone.
  EXPECT_NE(mesh.apply(open_boundary(mesh, b).repatch), "");
  EXPECT_TRUE(sound(mesh));
}

TEST(IrregularOperations, AnArchiveMayGlueToACoarserQuad) {
  // Of the level-2 quads that those of operation 1 were glued to, the coarser operation 2 leaves none.
  HybridMesh mesh = grid(2, 1);
  mesh.refine_uniform(2);
  const int left = mesh.first_child(0) + 1, right = mesh.first_child(1);
  const int hole = mesh.first_child(right) + 3;
  const std::vector<HalfEdge> around = find_disk_region(mesh, {hole}).boundary;
  ASSERT_EQ(mesh.apply(open_boundary(mesh, {hole}).repatch), "");
  Repatch fill;
  fill.level = 2;
  fill.quads = {{0, 1, 2, 3}};
  fill.sides.resize(1);
  for (int s = 0; s < 4; ++s) {
    fill.boundary.push_back(mesh.from(around[s]));
    fill.sides[0][s].kind = Repatch::Side::Kind::Outer;
    fill.sides[0][s].half = around[s];
  }
  ASSERT_EQ(mesh.apply(fill), "");
  ASSERT_EQ(mesh.apply(free_layout(mesh, {left}, {{0, 1, 2, 3}}).repatch), "");
  EXPECT_TRUE(sound_but_for_balance(mesh));
  const HybridMesh again = put_together(take_apart(mesh));
  EXPECT_TRUE(sound_but_for_balance(again));
  EXPECT_EQ(again.final_mesh().indices, mesh.canonical().final_mesh().indices);
}

TEST(IrregularOperations, NoChoiceJoinsTwoVerticesTwice) {
  // Six sides around two quads: their middle edge is removed, then made again on the other side.
  HybridMesh mesh = cube();
  mesh.refine_uniform(1);
  const std::vector<int> two{mesh.first_child(0), mesh.first_child(0) + 1};
  std::vector<int> others;
  for (int n : active_of_level(mesh, 1))
    if (n != two[0] && n != two[1]) others.push_back(n);
  const DiskRegion region = find_disk_region(mesh, two);
  int middle = 0;  // first of the corners that the middle edge joins
  const auto has = [&](int n, VertexId v) {
    return mesh.corner(n, 0) == v || mesh.corner(n, 1) == v || mesh.corner(n, 2) == v || mesh.corner(n, 3) == v;
  };
  while (!has(two[0], region.corners[middle]) || !has(two[1], region.corners[middle])) ++middle;
  const auto halves = [](int from) {
    return std::vector<std::array<int, 4>>{{from % 6, (from + 1) % 6, (from + 2) % 6, (from + 3) % 6},
                                           {(from + 3) % 6, (from + 4) % 6, (from + 5) % 6, from % 6}};
  };
  const DiskRegion back = find_disk_region(mesh, others);
  const int start = static_cast<int>(std::find(back.corners.begin(), back.corners.end(), region.corners[middle]) - back.corners.begin());
  EXPECT_NE(mesh.apply(free_layout(mesh, others, halves(start)).repatch), "");
  ASSERT_EQ(mesh.apply(free_layout(mesh, two, halves(middle + 1)).repatch), "");
  ASSERT_EQ(mesh.apply(free_layout(mesh, others, halves(start)).repatch), "");
  EXPECT_TRUE(sound(mesh));
  const auto before = everything(mesh);
  EXPECT_NE(mesh.set_enabled({false, true}), "");
  EXPECT_EQ(everything(mesh), before);
  EXPECT_EQ(mesh.set_enabled({true, false}), "");
}

TEST(IrregularOperations, NoCoarserOperationDoublesAnEdge) {
  // The edge from u to w goes, a tube of finer quads makes it again, then quads of the coarser level around would.
  HybridMesh mesh = square_grid(3);
  const auto cell = [&](int level, int x, int y) { return block(mesh, level, x, y, x + 1, y + 1)[0]; };
  const std::vector<int> two{cell(2, 1, 0), cell(2, 1, 1)}, around{cell(2, 0, 1), cell(2, 0, 2), cell(2, 1, 2), cell(2, 2, 2), cell(2, 2, 1)};
  const VertexId u = mesh.corner(two[1], 0), w = mesh.corner(two[1], 1);
  const auto from = [&](const std::vector<int>& nodes, VertexId vertex) {
    const DiskRegion region = find_disk_region(mesh, nodes);
    return region.boundary[std::find(region.corners.begin(), region.corners.end(), vertex) - region.corners.begin()];
  };
  ASSERT_EQ(mesh.apply(free_layout(mesh, two, {{1, 2, 3, 4}, {4, 5, 0, 1}}, from(two, u)).repatch), "");
  // Side 3 of the finer quad below u begins at u, side 1 of that below w at w's other end.
  const std::vector<int> a{cell(3, 1, 1)}, b{cell(3, 4, 1)};
  bool joined = false;
  for (int turn = 0; turn < 4 && !joined; ++turn) {
    const OperationDraft tube = connect(mesh, a, b, turn);
    ASSERT_EQ(tube.reason, "");
    for (const auto& quad : tube.repatch.quads)
      for (int s = 0; s < 4; ++s)
        joined |= quad[s] >= 0 && quad[(s + 1) % 4] >= 0 && tube.repatch.boundary[quad[s]] == u && tube.repatch.boundary[quad[(s + 1) % 4]] == w;
    if (joined) {
      ASSERT_EQ(mesh.apply(tube.repatch), "");
    }
  }
  ASSERT_TRUE(joined);
  const DiskRegion region = find_disk_region(mesh, around, from(around, u));
  const int n = static_cast<int>(region.corners.size()),
            at = static_cast<int>(std::find(region.corners.begin(), region.corners.end(), w) - region.corners.begin());
  ASSERT_EQ(at % 2, 1);
  // Quads in a fan around u on both sides of the new edge.
  std::vector<std::array<int, 4>> fan;
  for (int k = 1; k + 2 < n; k += 2) fan.push_back({0, k, k + 1, k + 2});
  const std::string reason = mesh.apply(free_layout(mesh, around, fan, from(around, u)).repatch);
  EXPECT_NE(reason.find("second edge"), std::string::npos) << reason;
  EXPECT_TRUE(sound_but_for_balance(mesh));
}

TEST(IrregularOperations, NoChoiceLeavesNothing) {
  HybridMesh mesh = square_grid(1);
  // A quad grows on the boundary, then all others go.
  Repatch grown;
  grown.level = 1;
  const HalfEdge rim = mesh.half_edge(mesh.first_child(0), 0) ^ 1;
  grown.boundary = {mesh.from(rim), mesh.to(rim)};
  grown.new_vertices = 2;
  grown.quads = {{0, 1, -1, -2}};
  grown.sides.resize(1);
  grown.sides[0][0].kind = Repatch::Side::Kind::Outer;
  grown.sides[0][0].half = rim;
  ASSERT_EQ(mesh.apply(grown), "");
  ASSERT_EQ(mesh.apply(open_boundary(mesh, active_of_level(mesh, 1)).repatch), "");
  EXPECT_EQ(mesh.leaves().size(), 1u);
  const auto before = everything(mesh);
  EXPECT_NE(mesh.set_enabled({false, true}), "");
  EXPECT_EQ(everything(mesh), before);
}

}  // namespace
}  // namespace hybrid_mesh
