// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_layout.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

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
    const std::optional<PatchRegion> region = make_region(layout, {patches.begin(), patches.end()});
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
      const std::optional<PatchRegion> region = make_region(layout, patches, {q, i});
      ASSERT_EQ(region.has_value(), inside && (i % 2 == 0 || (q == 4 && i == 3) || (q == 6 && i == 1))) << q << " " << i;
      if (region) {
        EXPECT_EQ(region->boundary.front().patch, q);
        EXPECT_EQ(region->boundary.front().side, i);
      }
    }
}

}  // namespace
}  // namespace hybrid_mesh
