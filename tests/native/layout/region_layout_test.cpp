// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_layout.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "layout/regions/region_pattern.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

// Quads without a surface: all that regions are found by.
PatchedSurface layout_of(const std::vector<std::array<int, 4>>& quads) {
  PatchedSurface layout;
  layout.nodes = quads;
  layout.neighbours.resize(quads.size());
  std::map<std::pair<int, int>, PatchSide> sides;
  for (int q = 0; q < layout.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      sides[{quads[q][i], quads[q][(i + 1) % 4]}] = {q, i};
      layout.node_count = std::max(layout.node_count, quads[q][i] + 1);
    }
  for (const auto& [ends, side] : sides)
    if (const auto other = sides.find({ends.second, ends.first}); other != sides.end()) layout.neighbours[side.patch][side.side] = other->second;
  return layout;
}

// Rows of quads, closed to a tube or not, from node `first` on.
void add_grid(std::vector<std::array<int, 4>>& quads, int columns, int rows, bool closed_columns, bool closed_rows, int first) {
  const int across = closed_columns ? columns : columns + 1, up = closed_rows ? rows : rows + 1;
  const auto at = [&](int x, int y) { return first + (y % up) * across + x % across; };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) quads.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
}

// A sheet, a tube and a torus beside one another.
PatchedSurface three_components() {
  std::vector<std::array<int, 4>> quads;
  add_grid(quads, 4, 3, false, false, 0);
  add_grid(quads, 3, 3, true, false, 20);
  add_grid(quads, 3, 3, true, true, 32);
  return layout_of(quads);
}

// Connected by sides, with one boundary that meets no node twice, and of Euler number one.
bool is_disk(const PatchedSurface& layout, const std::set<int>& patches) {
  if (patches.empty()) return false;
  std::set<int> reached{*patches.begin()};
  std::vector<int> stack{*patches.begin()};
  std::map<int, int> next;
  std::set<int> nodes;
  int inner_sides = 0, rim = 0;
  while (!stack.empty()) {
    const int q = stack.back();
    stack.pop_back();
    for (int i = 0; i < 4; ++i) {
      const int other = layout.neighbours[q][i].patch;
      nodes.insert(layout.nodes[q][i]);
      if (patches.count(other)) {
        ++inner_sides;
        if (reached.insert(other).second) stack.push_back(other);
      } else {
        ++rim;
        if (!next.insert({layout.nodes[q][i], layout.nodes[q][(i + 1) % 4]}).second) return false;
      }
    }
  }
  if (reached.size() != patches.size() || rim == 0) return false;
  int around = 0, node = next.begin()->first;
  do {
    node = next.at(node);
    ++around;
  } while (node != next.begin()->first && around <= rim);
  return around == rim && static_cast<int>(nodes.size()) - (inner_sides / 2 + rim) + static_cast<int>(patches.size()) == 1;
}

TEST(PatchRegion, IsADisk) {
  const PatchedSurface layout = three_components();
  TestRandom random(1);
  int disks = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    // A patch and some beside it; sometimes a whole component or a patch anywhere.
    std::set<int> patches{random.below(layout.patch_count())};
    for (int k = random.below(12); k > 0; --k) {
      auto from = patches.begin();
      std::advance(from, random.below(static_cast<int>(patches.size())));
      if (const int other = layout.neighbours[*from][random.below(4)].patch; other >= 0) patches.insert(other);
    }
    if (random.below(4) == 0)
      for (int q = 21; q < layout.patch_count(); ++q) patches.insert(q);
    if (random.below(8) == 0) patches.insert(random.below(layout.patch_count()));
    const std::optional<PatchRegion> region = make_disk(layout, {patches.begin(), patches.end()});
    EXPECT_EQ(region.has_value(), is_disk(layout, patches)) << trial;
    if (!region) continue;
    ++disks;
    EXPECT_EQ(region->boundary.size(), region->corners.size());
    for (std::size_t k = 0; k < region->boundary.size(); ++k) {
      const PatchSide& s = region->boundary[k];
      EXPECT_EQ(layout.nodes[s.patch][s.side], region->corners[k]);
      EXPECT_EQ(layout.nodes[s.patch][(s.side + 1) % 4], region->corners[(k + 1) % region->corners.size()]);
    }
  }
  EXPECT_GT(disks, 500);
}

// Euler number of some patches with their boundary.
int euler_of(const QuadGraph& layout, const std::vector<int>& patches) {
  std::set<int> nodes;
  int half_sides = 0;
  for (const int q : patches)
    for (int i = 0; i < 4; ++i) {
      nodes.insert(layout.nodes[q][i]);
      half_sides += std::count(patches.begin(), patches.end(), layout.neighbours[q][i].patch) > 0 ? 1 : 2;
    }
  return static_cast<int>(nodes.size()) - half_sides / 2 + static_cast<int>(patches.size());
}

// The region's own quads, as an edit names them.
LayoutEdit own_quads(const QuadGraph& layout, const PatchRegion& region) {
  LayoutEdit edit = edit_of(region);
  std::map<int, int> number;
  for (std::size_t k = 0; k < region.corners.size(); ++k) number[region.corners[k]] = static_cast<int>(k);
  for (const int n : region.inner_nodes) number.insert({n, static_cast<int>(number.size())});
  edit.inner_nodes = static_cast<int>(region.inner_nodes.size());
  for (const int q : region.patches) {
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) quad[i] = number.at(layout.nodes[q][i]);
    edit.quads.push_back(quad);
  }
  return edit;
}

TEST(PatchRegion, OfAnyTopologyGetsItsOwnQuadsBack) {
  const PatchedSurface layout = three_components();
  TestRandom random(7);
  std::map<std::pair<int, int>, int> seen;  // pieces and rims
  int opened = 0, handles = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    std::set<int> patches;
    for (int pieces = 1 + random.below(2); pieces > 0; --pieces) {
      std::set<int> piece{random.below(layout.patch_count())};
      for (int k = random.below(14); k > 0; --k) {
        auto from = piece.begin();
        std::advance(from, random.below(static_cast<int>(piece.size())));
        if (const int other = layout.neighbours[*from][random.below(4)].patch; other >= 0) piece.insert(other);
      }
      patches.insert(piece.begin(), piece.end());
    }
    const FreeLoops loops = random.below(2) ? FreeLoops::Open : FreeLoops::Rims;
    const std::vector<int> given(patches.begin(), patches.end());
    const std::optional<PatchRegion> region = make_region(layout, given, {}, loops);
    if (!region) continue;
    ++seen[{static_cast<int>(region->pieces.size()), region->rim_count()}];
    int euler = 0;
    for (const RegionPiece& piece : region->pieces) {
      euler += piece.euler;
      opened += piece.open_loops > 0;
      handles += 2 - piece.euler - static_cast<int>(piece.rims.size()) - piece.open_loops >= 2;
    }
    EXPECT_EQ(euler, euler_of(layout, given));
    // Rims are closed walks.
    for (std::size_t k = 0; k < region->boundary.size(); ++k) {
      const PatchSide& s = region->boundary[k];
      EXPECT_EQ(layout.nodes[s.patch][s.side], region->corners[k]);
      EXPECT_EQ(layout.nodes[s.patch][(s.side + 1) % 4], region->corners[region->next(static_cast<int>(k))]);
    }
    const LayoutEdit edit = own_quads(layout, *region);
    EXPECT_EQ(find_filling_defect(edit.quads, *region), "");
    QuadGraph again = layout.graph();
    const LayoutChange change = change_layout(again, edit);
    ASSERT_EQ(again.patch_count(), layout.patch_count());
    ASSERT_EQ(again.node_count, layout.node_count);
    // Where each patch is now.
    std::vector<int> now = change.patch;
    for (std::size_t k = 0; k < given.size(); ++k) now[given[k]] = change.added[k];
    for (int q = 0; q < layout.patch_count(); ++q)
      for (int i = 0; i < 4; ++i) {
        const PatchSide before = layout.neighbours[q][i], after = again.neighbours[now[q]][i];
        EXPECT_EQ(after.patch, before.patch < 0 ? -1 : now[before.patch]);
        if (before.patch >= 0) {
          EXPECT_EQ(after.side, before.side);
        }
      }
    // One quad less is another surface, but for one at an open loop.
    if (edit.quads.size() > 1 && loops == FreeLoops::Rims) {
      std::vector<std::array<int, 4>> fewer(edit.quads.begin() + 1, edit.quads.end());
      EXPECT_NE(find_filling_defect(fewer, *region), "");
    }
  }
  EXPECT_GT((seen[{1, 1}]), 100);
  EXPECT_GT((seen[{1, 2}]), 100);
  EXPECT_GT((seen[{2, 2}]), 100);
  EXPECT_GT(opened, 100);
  EXPECT_GT(handles, 20);
}

TEST(PatchRegion, HasEachPatchOnce) {
  const PatchedSurface layout = three_components();
  // A sheet with its middle patches given twice or three times: as many sides on the rim as without.
  std::vector<int> patches(12);
  for (int q = 0; q < 12; ++q) patches[q] = q;
  ASSERT_TRUE(make_region(layout, patches));
  for (const int q : {0, 5, 6}) {
    patches.push_back(q);
    EXPECT_FALSE(make_region(layout, patches));
  }
}

TEST(PatchRegion, BeginsWhereItIsTold) {
  const PatchedSurface layout = three_components();
  const std::vector<int> patches{4, 5, 6};
  for (int q = 0; q < layout.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      const bool inside = q >= 4 && q <= 6;
      const std::optional<PatchRegion> region = make_region(layout, patches, {PatchSide{q, i}});
      ASSERT_EQ(region.has_value(), inside && (i % 2 == 0 || (q == 4 && i == 3) || (q == 6 && i == 1))) << q << " " << i;
      if (region) {
        EXPECT_EQ(region->boundary.front().patch, q);
        EXPECT_EQ(region->boundary.front().side, i);
      }
    }
}

}  // namespace
}  // namespace hybrid_mesh
