// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/irregular_operations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include "base/error.h"
#include "hierarchy/archive.h"
#include "hierarchy/bases.h"
#include "hierarchy/brute_force.h"
#include "layout/disks/disk_layout.h"

namespace hybrid_mesh {
namespace {

// For each corner of a region the number of quads inside that makes it regular: four around it with those outside, two on the mesh's boundary; at
// least one.
std::vector<int> regular_quads(const DiskRegion& region) {
  std::vector<int> result;
  for (std::size_t k = 0; k < region.corners.size(); ++k) result.push_back(std::max(1, (region.on_mesh_boundary[k] ? 2 : 4) - region.outside[k]));
  return result;
}

testing::AssertionResult sound(const HybridMesh& mesh) {
  const auto defects = find_defects(mesh);
  if (!defects.empty()) return testing::AssertionFailure() << defects.size() << " defects, first: " << defects[0];
  const std::string wrong = find_wrong_answer(mesh);
  if (!wrong.empty()) return testing::AssertionFailure() << "wrong answer: " << wrong;
  return testing::AssertionSuccess();
}

// The same, but leaves may differ by any number of levels.
testing::AssertionResult sound_but_for_balance(const HybridMesh& mesh) {
  for (const std::string& defect : find_defects(mesh))
    if (defect.find("levels' difference") == std::string::npos && defect.find("has finer neighbours on") == std::string::npos)
      return testing::AssertionFailure() << "a defect: " << defect;
  const std::string wrong = find_wrong_answer(mesh);
  if (!wrong.empty()) return testing::AssertionFailure() << "wrong answer: " << wrong;
  return testing::AssertionSuccess();
}

std::vector<int> active_of_level(const HybridMesh& mesh, int level) {
  std::vector<int> result;
  for (int n = 0; n < mesh.node_count(); ++n)
    if (mesh.is_active(n) && mesh.level(n) == level && !mesh.is_root(n)) result.push_back(n);
  return result;
}

bool same(const Repatch& a, const Repatch& b) {
  if (a.level != b.level || a.removed != b.removed || a.new_vertices != b.new_vertices || a.quads != b.quads || a.boundary != b.boundary ||
      a.kind != b.kind || a.sides.size() != b.sides.size())
    return false;
  for (std::size_t q = 0; q < a.sides.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      const Repatch::Side &x = a.sides[q][s], &y = b.sides[q][s];
      if (x.kind != y.kind || x.quad != y.quad || x.side != y.side || x.half != y.half) return false;
    }
  return true;
}

bool same(const HierarchyParts& a, const HierarchyParts& b) {
  if (a.base_vertices != b.base_vertices || a.base_quads != b.base_quads || a.base_links != b.base_links || a.refined != b.refined ||
      a.enabled != b.enabled || a.operations.size() != b.operations.size())
    return false;
  for (std::size_t o = 0; o < a.operations.size(); ++o)
    if (!same(a.operations[o], b.operations[o])) return false;
  return true;
}

// Everything that the hierarchy tells of itself.
std::vector<std::int64_t> everything(const HybridMesh& mesh) {
  std::vector<std::int64_t> result{mesh.node_count(), mesh.operation_count(), mesh.leaf_counts().vertices, mesh.leaf_counts().hanging,
                                   mesh.leaf_counts().euler};
  for (int n = 0; n < mesh.node_count(); ++n) {
    for (std::int64_t x : {mesh.level(n), mesh.parent(n), mesh.first_child(n), mesh.root(n), mesh.inserted_by(n), mesh.removed_by(n),
                           static_cast<int>(mesh.is_active(n))})
      result.push_back(x);
    for (int s = 0; s < 4; ++s) {
      const SideLink other = mesh.neighbour(n, s);
      for (std::int64_t x : {mesh.half_edge(n, s), mesh.corner(n, s).code, other.node, other.side}) result.push_back(x);
    }
  }
  for (int o = 0; o < mesh.operation_count(); ++o) {
    result.push_back(mesh.operation(o).enabled);
    for (int d : mesh.operation(o).depends) result.push_back(d);
  }
  return result;
}

// --- single operations ---------------------------------------------------------------------------------------------------------------------------

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

// --- random sequences --------------------------------------------------------------------------------------------------------------------------

struct SequenceBase {
  std::string name;
  HybridMesh mesh;
  bool simple;  // no two edges between the same vertices
};

HybridMesh two_components() {
  return HybridMesh::from_base(14,
                               {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {8, 9, 12, 11}, {9, 10, 13, 12}});
}

// A quad whose sides 1 and 3 are glued: a ring.
HybridMesh ring_of_one() { return HybridMesh::from_base(2, {{0, 0, 1, 1}}, {{SideLink{}, SideLink{0, 3}, SideLink{}, SideLink{0, 1}}}); }

// A quad folded along a diagonal: a sphere with two vertices of one quad.
HybridMesh folded_quad() { return HybridMesh::from_base(3, {{0, 1, 0, 2}}, {{SideLink{0, 1}, SideLink{0, 0}, SideLink{0, 3}, SideLink{0, 2}}}); }

std::vector<SequenceBase> sequence_bases() {
  std::vector<SequenceBase> result;
  result.push_back({"cube", cube(), true});
  result.push_back({"torus", torus(3, 3), true});
  result.push_back({"components", two_components(), true});
  result.push_back({"grid", grid(3, 2), true});
  result.push_back({"pillow", pillow(), false});
  result.push_back({"torus_of_one", torus(1, 1), false});
  result.push_back({"ring_of_one", ring_of_one(), false});
  result.push_back({"folded_quad", folded_quad(), false});
  return result;
}

class Sequence {
 public:
  Sequence(const SequenceBase& base, unsigned seed) : mesh_(base.mesh), simple_(base.simple), random_(seed) {}

  // False at the first thing that is wrong.
  testing::AssertionResult run(int steps) {
    mesh_.refine_uniform(mesh_.base_count() < 3 ? 2 : 1);
    for (int step = 0; step < steps; ++step) {
      take_step();
      if (mesh_.leaves().empty()) failure_ = "nothing is left";
      if (simple_ && BruteForce(mesh_).double_pieces() > 0) failure_ = "two vertices are joined twice";
      if (!failure_.empty()) return testing::AssertionFailure() << failure_ << log_.str();
      // Half of the time the next step meets the mesh as this one left it.
      testing::AssertionResult good = sound_but_for_balance(mesh_);
      if (!good) return good << log_.str();
      if (chance(2)) {
        mesh_.balance();
        log_ << "; balance";
        good = sound(mesh_);
        if (!good) return good << log_.str();
      }
    }
    mesh_.balance();
    testing::AssertionResult good = sound(mesh_);
    if (!good) return good << log_.str() << "; balance at the end";
    HybridMesh again;
    try {
      again = put_together(take_apart(mesh_));
    } catch (const Error& error) {
      return testing::AssertionFailure() << "cannot be put together again (" << error.what() << ")" << log_.str();
    }
    good = sound(again);
    if (!good) return good << log_.str() << "; put together again";
    if (!same(take_apart(again), take_apart(mesh_))) return testing::AssertionFailure() << "not the same when put together again" << log_.str();
    return testing::AssertionSuccess();
  }

  static std::map<std::string, int>& outcomes() {
    static std::map<std::string, int> counts;
    return counts;
  }

 private:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  bool chance(int n) { return below(n) == 0; }

  void take_step() {
    const bool all_enabled = [&] {
      for (bool on : mesh_.enabled())
        if (!on) return false;
      return true;
    }();
    const int choice = below(12);
    if (!all_enabled && choice >= 4) {
      // Operations need all earlier ones.
      choose_enabled(chance(3) ? random_subset() : std::vector<bool>(mesh_.operation_count(), true));
    } else if (choice == 0) {
      const int leaf = random_leaf();
      if (mesh_.level(leaf) >= 5) return;
      log_ << "; refine " << leaf;
      mesh_.refine(leaf);
    } else if (choice <= 2) {
      const int leaf = random_leaf();
      if (mesh_.level(leaf) >= 4) return;
      log_ << "; refine balanced " << leaf;
      mesh_.refine_balanced(leaf);
    } else if (choice == 3) {
      if (mesh_.operation_count() > 0) choose_enabled(random_subset());
    } else {
      operate(choice);
    }
  }

  int random_leaf() {
    const std::vector<int> leaves = mesh_.leaves();
    // New quads are refined more often: later operations stand on them.
    if (mesh_.operation_count() > 0 && chance(2)) {
      std::vector<int> fresh;
      for (int n : leaves)
        if (mesh_.inserted_by(n) >= 0) fresh.push_back(n);
      if (!fresh.empty()) return fresh[below(static_cast<int>(fresh.size()))];
    }
    return leaves[below(static_cast<int>(leaves.size()))];
  }

  std::vector<bool> random_subset() {
    std::vector<bool> enabled(mesh_.operation_count());
    const bool closed = !chance(4);
    for (int o = 0; o < mesh_.operation_count(); ++o) {
      enabled[o] = !chance(3);
      for (int d : mesh_.operation(o).depends) enabled[o] = enabled[o] && (enabled[d] || !closed);
    }
    return enabled;
  }

  void choose_enabled(const std::vector<bool>& enabled) {
    log_ << "; enable ";
    for (bool on : enabled) log_ << on;
    const auto before = everything(mesh_);
    note("set_enabled", mesh_.set_enabled(enabled), before);
  }

  // Active quads around one of them, often next to those of an earlier operation.
  std::vector<int> random_region(int level, int most) {
    const std::vector<int> candidates = active_of_level(mesh_, level);
    if (candidates.empty()) return {};
    std::vector<int> region{candidates[below(static_cast<int>(candidates.size()))]};
    const int size = 1 + below(most);
    for (int tries = 0; tries < 4 * size && static_cast<int>(region.size()) < size; ++tries) {
      const SideLink other = mesh_.neighbour(region[below(static_cast<int>(region.size()))], below(4));
      if (!other.valid() || mesh_.level(other.node) != level || mesh_.is_root(other.node)) continue;
      if (std::find(region.begin(), region.end(), other.node) != region.end()) continue;
      region.push_back(other.node);
      if (!find_disk_region(mesh_, region).reason.empty() && !chance(8)) region.pop_back();
    }
    return region;
  }

  int random_level() {
    const int level = 1 + below(3);
    return std::min(level, std::max(1, mesh_.depth()));
  }

  // The region's own quads, around which a ring may be laid, a node joined to every second corner, or what the corners ask for, or chance.
  std::vector<std::array<int, 4>> random_layout(const DiskRegion& region) {
    const int n = static_cast<int>(region.corners.size());
    std::vector<std::array<int, 4>> quads;
    const int kind = below(5);
    if (kind >= 3) {
      std::vector<int> wishes = regular_quads(region);
      if (kind == 4)
        for (int& q : wishes) q = 1 + below(3);
      Context context;
      return fill_disk(wishes, Progress(context)).quads;
    }
    if (kind == 0 && n >= 6) {
      for (int k = 0; k < n; k += 2) quads.push_back({k, k + 1, (k + 2) % n, n});
      return quads;
    }
    const int shift = kind == 1 ? n : 0;
    std::map<VertexId, int> name;
    for (int k = 0; k < n; ++k) name[region.corners[k]] = k + shift;
    for (int node : region.nodes) {
      std::array<int, 4> quad;
      for (int i = 0; i < 4; ++i) quad[i] = name.try_emplace(mesh_.corner(node, i), static_cast<int>(name.size()) + shift).first->second;
      quads.push_back(quad);
    }
    for (int k = 0; k < n && shift > 0; ++k) quads.push_back({k, (k + 1) % n, n + (k + 1) % n, n + k});
    return quads;
  }

  void operate(int choice) {
    const int level = random_level();
    const std::vector<int> region = random_region(level, 5);
    if (region.empty()) return;
    OperationDraft draft;
    std::string kind;
    if (choice <= 5) {
      kind = "add_cubes";
      draft = add_cubes(mesh_, region, 1 + below(2));
    } else if (choice <= 7) {
      kind = "connect";
      std::vector<int> other;
      // Regions apart from each other, if chance finds any.
      for (int tries = 0; tries < 6; ++tries) {
        other = random_region(level, 5);
        draft = connect(mesh_, region, other, below(7) - 3);
        if (draft.reason.empty()) break;
      }
    } else if (choice == 8) {
      kind = "open_boundary";
      draft = open_boundary(mesh_, region);
      if (draft.reason.empty()) opened_.push_back(region);
    } else if (choice == 9 && !opened_.empty()) {
      // The quads of a hole that an earlier operation left are put back as root quads.
      kind = "fill";
      const std::vector<int>& hole = opened_[below(static_cast<int>(opened_.size()))];
      draft.repatch.kind = kind;
      draft.repatch.level = mesh_.level(hole[0]);
      std::map<VertexId, int> name;
      std::map<HalfEdge, SideLink> sides;
      for (std::size_t q = 0; q < hole.size(); ++q)
        for (int s = 0; s < 4; ++s) sides[mesh_.half_edge(hole[q], s)] = {static_cast<int>(q), s};
      for (int n : hole) {
        std::array<int, 4> quad;
        std::array<Repatch::Side, 4> links;
        for (int s = 0; s < 4; ++s) {
          const auto [at, fresh] = name.try_emplace(mesh_.corner(n, s), static_cast<int>(name.size()));
          if (fresh) draft.repatch.boundary.push_back(mesh_.corner(n, s));
          quad[s] = at->second;
          const auto across = sides.find(mesh_.half_edge(n, s) ^ 1);
          links[s].kind = across != sides.end() ? Repatch::Side::Kind::Patch : Repatch::Side::Kind::Outer;
          if (across != sides.end()) {
            links[s].quad = across->second.node;
            links[s].side = across->second.side;
          } else {
            links[s].half = mesh_.half_edge(n, s);
          }
        }
        draft.repatch.quads.push_back(quad);
        draft.repatch.sides.push_back(links);
      }
    } else {
      kind = "free_layout";
      const DiskRegion disk = find_disk_region(mesh_, region);
      draft = disk.reason.empty() && disk.corners.size() >= 4 ? free_layout(mesh_, region, random_layout(disk))
                                                              : OperationDraft{{}, "no disk: " + disk.reason};
    }
    log_ << "; " << kind << " of level " << level << " at";
    for (int n : draft.repatch.removed) log_ << " " << n;
    if (!draft.reason.empty()) {
      note(kind + " (builder)", draft.reason, everything(mesh_));
      return;
    }
    const auto before = everything(mesh_);
    const bool thorough = chance(4);
    const HierarchyParts parts = thorough ? take_apart(mesh_) : HierarchyParts{};
    const std::string reason = mesh_.apply(draft.repatch);
    note(kind, reason, before);
    if (!reason.empty() && thorough && !same(parts, take_apart(mesh_))) failure_ = "a refused " + kind + " changed the archive";
  }

  void note(const std::string& what, const std::string& reason, const std::vector<std::int64_t>& before) {
    std::string plain;  // without numbers
    for (char c : reason)
      if (c < '0' || c > '9') plain += c;
    outcomes()[what + ": " + (reason.empty() ? "done" : plain)] += 1;
    log_ << (reason.empty() ? "" : " refused");
    if (!reason.empty() && everything(mesh_) != before) failure_ = "a refused " + what + " changed the hierarchy (" + reason + ")";
  }

  HybridMesh mesh_;
  bool simple_;
  std::mt19937 random_;
  std::vector<std::vector<int>> opened_;
  std::ostringstream log_;
  std::string failure_;
};

class RandomSequences : public testing::TestWithParam<std::pair<int, int>> {};

// Sequences of a base in a block: ten thousand in all.
constexpr int kBlocks = 5, kSequences = 250;

TEST_P(RandomSequences, KeepEveryInvariantAndAnswerEveryQuery) {
  const SequenceBase base = sequence_bases()[GetParam().first];
  // HYBRID_MESH_SEQUENCES: how many a block, for a longer run.
  const char* given = std::getenv("HYBRID_MESH_SEQUENCES");
  const int sequences = given ? std::atoi(given) : kSequences;
  for (int i = 0; i < sequences; ++i) {
    const unsigned seed = static_cast<unsigned>(GetParam().second * sequences + i);
    const testing::AssertionResult good = Sequence(base, seed).run(9);
    ASSERT_TRUE(good) << base.name << ", seed " << seed;
  }
  int done = 0, refused = 0;
  for (const auto& [what, count] : Sequence::outcomes()) (what.ends_with(": done") ? done : refused) += count;
  EXPECT_GT(done, refused);
  if (std::getenv("HYBRID_MESH_OUTCOMES"))
    for (const auto& [what, count] : Sequence::outcomes()) std::cout << count << " " << what << "\n";
}

std::vector<std::pair<int, int>> blocks() {
  std::vector<std::pair<int, int>> result;
  for (int base = 0; base < static_cast<int>(sequence_bases().size()); ++base)
    for (int b = 0; b < kBlocks; ++b) result.emplace_back(base, b);
  return result;
}

INSTANTIATE_TEST_SUITE_P(Hierarchy, RandomSequences, testing::ValuesIn(blocks()),
                         [](const auto& info) { return sequence_bases()[info.param.first].name + "_" + std::to_string(info.param.second); });

}  // namespace
}  // namespace hybrid_mesh
