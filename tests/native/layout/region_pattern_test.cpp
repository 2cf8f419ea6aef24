// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/region_pattern.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "layout/disks/disk_layout.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

using Quads = std::vector<std::array<int, 4>>;

Quads random_filling(TestRandom& random, int corners) {
  std::vector<int> wishes;
  for (int k = 0; k < corners; ++k) wishes.push_back(1 + random.below(3));
  Context context;
  return fill_disk(wishes, Progress(context)).quads;
}

TEST(FillingDefect, IsNoneInAFilledDisk) {
  TestRandom random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const int corners = 4 + 2 * random.below(6);
    EXPECT_EQ(find_filling_defect(random_filling(random, corners), corners), "");
  }
}

TEST(FillingDefect, IsFoundInWhateverElseIsGiven) {
  TestRandom random(2);
  for (int trial = 0; trial < 300; ++trial) {
    const int corners = 4 + 2 * random.below(6);
    const Quads filled = random_filling(random, corners);
    const auto expect_defect = [&](const Quads& quads, int of = 0) { EXPECT_NE(find_filling_defect(quads, of > 0 ? of : corners), "") << trial; };
    const int q = random.below(static_cast<int>(filled.size())), i = random.below(4);
    expect_defect(filled, corners + 1);
    expect_defect(filled, corners - 1);
    for (const int node : {-1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), corners + 4 * static_cast<int>(filled.size()),
                           filled[q][(i + 1) % 4], filled[q][(i + 2) % 4]}) {
      Quads other = filled;
      other[q][i] = node;
      expect_defect(other);
    }
    // An inner node that has another number in all its quads.
    const int inner = *std::max_element(filled[q].begin(), filled[q].end());
    for (const int node : {-1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), corners + 4 * static_cast<int>(filled.size())}) {
      if (inner < corners) continue;
      Quads other = filled;
      for (auto& quad : other) std::replace(quad.begin(), quad.end(), inner, node);
      expect_defect(other);
    }
    Quads fewer = filled;
    fewer.erase(fewer.begin() + q);
    expect_defect(fewer);
    Quads twice = filled;
    twice.push_back(filled[q]);
    expect_defect(twice);
    Quads turned = filled;
    std::reverse(turned[q].begin(), turned[q].end());
    expect_defect(turned);
    // A closed surface beside the disk.
    int first = corners;
    for (const auto& quad : filled) first = std::max(first, *std::max_element(quad.begin(), quad.end()) + 1);
    Quads beside = filled;
    for (const auto& quad : Quads{{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      beside.push_back(quad);
      for (int& n : beside.back()) n += first;
    }
    expect_defect(beside);
  }
}

}  // namespace
}  // namespace hybrid_mesh
