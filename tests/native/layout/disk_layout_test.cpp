// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/disks/disk_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

DiskLayout fill_disk(const std::vector<int>& quads_at) {
  Context context;
  return hybrid_mesh::fill_disk(quads_at, Progress(context));
}

DiskLayout fill_disk_with_ring(int edges) {
  Context context;
  return hybrid_mesh::fill_disk_with_ring(edges, Progress(context));
}

std::string name(const std::vector<int>& wishes) {
  std::string result;
  for (int q : wishes) result += std::to_string(q) + " ";
  return result;
}

std::vector<int> quads_around(const DiskLayout& layout, int n) {
  std::vector<int> result(n + layout.inner_nodes, 0);
  for (const auto& quad : layout.quads)
    for (int c : quad) result[c] += 1;
  return result;
}

int difference(const std::vector<int>& wishes, const std::vector<int>& around) {
  int sum = 0;
  for (std::size_t i = 0; i < wishes.size(); ++i) sum += std::abs(wishes[i] - around[i]);
  return sum;
}

int irregular_nodes(const DiskLayout& layout, int n) {
  const std::vector<int> around = quads_around(layout, n);
  return static_cast<int>(std::count_if(around.begin() + n, around.end(), [](int q) { return q != 4; }));
}

// What is wrong with a layout of a disk with n boundary nodes; empty if nothing is.
std::string find_defect(const DiskLayout& layout, int n) {
  const int nodes = n + layout.inner_nodes;
  std::map<std::pair<int, int>, int> sides;  // to the quad on the left
  for (std::size_t q = 0; q < layout.quads.size(); ++q) {
    const auto& quad = layout.quads[q];
    if (std::set<int>(quad.begin(), quad.end()).size() != 4) return "a quad with a node twice";
    for (int i = 0; i < 4; ++i) {
      if (quad[i] < 0 || quad[i] >= nodes) return "a node out of range";
      if (!sides.try_emplace({quad[i], quad[(i + 1) % 4]}, static_cast<int>(q)).second)
        return "two quads on one side of an edge, or two edges between two nodes";
    }
  }
  int edges = 0, boundary = 0;
  for (const auto& [ends, quad] : sides) {
    const bool inner = sides.count({ends.second, ends.first}) > 0;
    edges += !inner || ends.first < ends.second;
    if (inner) continue;
    ++boundary;
    if (ends.first >= n || ends.second != (ends.first + 1) % n) return "a boundary edge that is none of the disk's";
  }
  if (boundary != n) return "a boundary edge of the disk without a quad";
  if (nodes - edges + static_cast<int>(layout.quads.size()) != 1) return "an Euler number other than one";
  // One fan of quads a node: turning from quad to quad reaches all of them.
  const std::vector<int> around = quads_around(layout, n);
  std::vector<int> first(nodes, -1);  // a quad at the node, for a boundary node that with the boundary edge that leaves it
  for (std::size_t q = 0; q < layout.quads.size(); ++q)
    for (int i = 0; i < 4; ++i) {
      const int v = layout.quads[q][i];
      if (v >= n || layout.quads[q][(i + 1) % 4] == (v + 1) % n) first[v] = static_cast<int>(q);
    }
  for (int v = 0; v < nodes; ++v) {
    if (first[v] < 0) return "a node without a quad";
    int reached = 0, q = first[v];
    do {
      ++reached;
      const auto& quad = layout.quads[q];
      const int i = static_cast<int>(std::find(quad.begin(), quad.end(), v) - quad.begin());
      const auto next = sides.find({v, quad[(i + 3) % 4]});
      q = next == sides.end() ? -1 : next->second;
    } while (q >= 0 && q != first[v] && reached <= around[v]);
    if (reached != around[v]) return "a node with several fans of quads";
    if (v >= n && (around[v] < 3 || around[v] > 5)) return "an inner node of " + std::to_string(around[v]) + " quads";
  }
  return "";
}

// By how many right angles the boundary turns short of a full circle: so many inner nodes of three quads (or of five, if negative) there are more
// than of the other kind.
int missing_turns(const std::vector<int>& around, int n) { return 4 - 2 * n + std::accumulate(around.begin(), around.begin() + n, 0); }

// The least sum of differences of any rectangle's boundary from the wishes.
int distance_of_rectangles(const std::vector<int>& wishes) {
  const int n = static_cast<int>(wishes.size());
  int least = 1 << 30;
  for (int p = 0; p < n / 2; ++p)
    for (int a = 1; a < n / 2; ++a) {
      std::vector<int> around(n, 2);
      for (int k : {p, p + a, p + n / 2, p + n / 2 + a}) around[k % n] = 1;
      least = std::min(least, difference(wishes, around));
    }
  return least;
}

// What all layouts of a set are like.
struct Summary {
  int layouts = 0, kept = 0, irregular = 0, least = 0, quads = 0;
  std::map<int, int> differences;

  void add(const std::vector<int>& wishes, const DiskLayout& layout) {
    const int n = static_cast<int>(wishes.size());
    const std::vector<int> around = quads_around(layout, n);
    const int off = difference(wishes, around), turns = std::abs(missing_turns(around, n)), irregular_here = irregular_nodes(layout, n);
    ++layouts;
    ++differences[off];
    quads += static_cast<int>(layout.quads.size());
    kept += off == 0;
    irregular += irregular_here;
    // A disk that turns by a full circle has none, if it is rectilinear, or at least one of either kind.
    least += turns > 0 ? turns : irregular_here > 0 ? 2 : 0;
  }
  void record() const {
    testing::Test::RecordProperty("layouts", layouts);
    testing::Test::RecordProperty("wishes_kept", kept);
    testing::Test::RecordProperty("irregular_nodes", irregular);
    testing::Test::RecordProperty("least_irregular_nodes", least);
    testing::Test::RecordProperty("quads", quads);
    for (const auto& [off, count] : differences) testing::Test::RecordProperty("differences_of_" + std::to_string(off), count);
  }
};

testing::AssertionResult is_good(const std::vector<int>& wishes, const DiskLayout& layout) {
  const int n = static_cast<int>(wishes.size());
  const std::string defect = find_defect(layout, n);
  if (!defect.empty()) return testing::AssertionFailure() << defect << ", wished " << name(wishes);
  if (difference(wishes, quads_around(layout, n)) > distance_of_rectangles(wishes))
    return testing::AssertionFailure() << "a rectangle is nearer to the wishes " << name(wishes);
  return testing::AssertionSuccess();
}

TEST(DiskLayout, RectanglesAreGrids) {
  for (int a = 1; a <= 7; ++a)
    for (int b = 1; b <= 7; ++b)
      for (int turn : {0, 1, a, a + b}) {
        const int n = 2 * (a + b);
        std::vector<int> wishes(n, 2);
        for (int k : {0, a, a + b, 2 * a + b}) wishes[(k + turn) % n] = 1;
        const DiskLayout layout = fill_disk(wishes);
        EXPECT_TRUE(is_good(wishes, layout));
        EXPECT_EQ(layout.quads.size(), static_cast<std::size_t>(a * b));
        EXPECT_EQ(difference(wishes, quads_around(layout, n)), 0);
        EXPECT_EQ(irregular_nodes(layout, n), 0);
      }
}

// The numbers of quads at the boundary of a simply connected set of cells, counter-clockwise; empty if the boundary meets a point twice or is not one
// circle.
std::vector<int> boundary_of_cells(const std::set<std::pair<int, int>>& cells) {
  std::map<std::pair<int, int>, std::pair<int, int>> next;
  std::map<std::pair<int, int>, int> around;
  for (const auto& [x, y] : cells) {
    const std::pair<int, int> corners[4] = {{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}},
                              across[4] = {{x, y - 1}, {x + 1, y}, {x, y + 1}, {x - 1, y}};
    for (int s = 0; s < 4; ++s) {
      ++around[corners[s]];
      if (!cells.count(across[s]) && !next.try_emplace(corners[s], corners[(s + 1) % 4]).second) return {};
    }
  }
  std::vector<int> result;
  const auto start = next.begin()->first;
  for (auto at = start; result.empty() || at != start; at = next[at]) result.push_back(around[at]);
  return result.size() == next.size() ? result : std::vector<int>{};
}

TEST(DiskLayout, RectilinearShapesAreGrids) {
  std::mt19937 random(5);
  int shapes = 0;
  for (int k = 0; k < 400; ++k) {
    std::set<std::pair<int, int>> cells{{0, 0}};
    for (int size = 2 + static_cast<int>(random() % 40); static_cast<int>(cells.size()) < size;) {
      auto cell = *std::next(cells.begin(), static_cast<long>(random() % cells.size()));
      const int way = static_cast<int>(random() % 4);
      (way % 2 ? cell.first : cell.second) += way < 2 ? 1 : -1;
      auto larger = cells;
      if (larger.insert(cell).second && !boundary_of_cells(larger).empty()) cells = larger;
    }
    const std::vector<int> wishes = boundary_of_cells(cells);
    const DiskLayout layout = fill_disk(wishes);
    const int n = static_cast<int>(wishes.size());
    ASSERT_TRUE(is_good(wishes, layout));
    EXPECT_EQ(layout.quads.size(), cells.size());
    EXPECT_EQ(difference(wishes, quads_around(layout, n)), 0);
    EXPECT_EQ(irregular_nodes(layout, n), 0);
    ++shapes;
  }
  EXPECT_EQ(shapes, 400);
}

// Sides of so many edges between convex corners.
std::vector<int> polygon(const std::vector<int>& sides) {
  std::vector<int> wishes;
  for (int length : sides) {
    wishes.push_back(1);
    wishes.insert(wishes.end(), length - 1, 2);
  }
  return wishes;
}

TEST(DiskLayout, TrianglesAndPentagonsHaveOneIrregularNode) {
  // Lengths from the centre to the sides; a side is as long as those to its neighbours together.
  std::mt19937 random(8);
  for (int corners : {3, 5})
    for (int k = 0; k < 40; ++k) {
      std::vector<int> inwards(corners), sides(corners);
      for (int& d : inwards) d = 1 + static_cast<int>(random() % 4);
      for (int i = 0; i < corners; ++i) sides[i] = inwards[(i + 1) % corners] + inwards[(i + corners - 1) % corners];
      const std::vector<int> wishes = polygon(sides);
      const int n = static_cast<int>(wishes.size());
      const DiskLayout layout = fill_disk(wishes);
      ASSERT_TRUE(is_good(wishes, layout));
      EXPECT_EQ(difference(wishes, quads_around(layout, n)), 0);
      EXPECT_EQ(irregular_nodes(layout, n), 1);
    }
}

TEST(DiskLayout, UnequalSidesTakeTwoIrregularNodes) {
  for (int more = 1; more <= 3; ++more)
    for (int turn = 0; turn < 4; ++turn) {
      std::vector<int> sides{6, 5, 6 + 2 * more, 5};
      std::rotate(sides.begin(), sides.begin() + turn, sides.end());
      const std::vector<int> wishes = polygon(sides);
      const DiskLayout layout = fill_disk(wishes);
      ASSERT_TRUE(is_good(wishes, layout));
      EXPECT_EQ(difference(wishes, quads_around(layout, static_cast<int>(wishes.size()))), 0);
      EXPECT_EQ(irregular_nodes(layout, static_cast<int>(wishes.size())), 2);
    }
}

TEST(DiskLayout, SmoothBoundariesTakeFourIrregularNodes) {
  for (int n = 4; n <= 60; n += 2) {
    const std::vector<int> wishes(n, 2);
    const DiskLayout layout = fill_disk(wishes);
    ASSERT_TRUE(is_good(wishes, layout));
    EXPECT_EQ(difference(wishes, quads_around(layout, n)), 0);
    EXPECT_EQ(irregular_nodes(layout, n), 4);
  }
}

TEST(DiskLayout, BadBoundariesAreRefusedInWords) {
  for (int n : {0, 1, 2, 3, 5, 17}) {
    try {
      fill_disk(std::vector<int>(n, 2));
      ADD_FAILURE() << n;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
      EXPECT_NE(std::string(error.what()).find(std::to_string(n)), std::string::npos);
    }
  }
  for (int wish : {-1000000, -1, 0, 4, 7, 1000000})
    for (int n : {4, 6, 10, 16}) {
      std::vector<int> wishes(n, 2);
      wishes[n / 2] = wish;
      EXPECT_EQ(find_defect(fill_disk(wishes), n), "");
      EXPECT_EQ(find_defect(fill_disk(std::vector<int>(n, wish)), n), "");
    }
}

TEST(DiskLayout, TheLayoutTurnsWithTheWishes) {
  std::mt19937 random(2);
  for (int k = 0; k < 100; ++k) {
    const int n = 6 + 2 * static_cast<int>(random() % 8);
    std::vector<int> wishes(n);
    for (int& q : wishes) q = 1 + static_cast<int>(random() % 3);
    bool symmetric = false;
    for (int turn = 1; turn < n; ++turn) {
      std::vector<int> turned = wishes;
      std::rotate(turned.begin(), turned.begin() + turn, turned.end());
      symmetric |= turned == wishes;
    }
    if (symmetric) continue;
    const DiskLayout layout = fill_disk(wishes);
    const int turn = 1 + static_cast<int>(random() % (n - 1));
    std::vector<int> turned = wishes;
    std::rotate(turned.begin(), turned.begin() + turn, turned.end());
    DiskLayout other = fill_disk(turned);
    for (auto& quad : other.quads)
      for (int& c : quad)
        if (c < n) c = (c + turn) % n;
    EXPECT_EQ(other.quads, layout.quads);
  }
}

// All patterns of one, two and three quads at the boundary nodes, but for rotations.
class AllPatterns : public testing::TestWithParam<std::pair<int, int>> {};

constexpr int kParts = 6;  // of the patterns of twelve nodes

TEST_P(AllPatterns, HaveGoodLayouts) {
  const auto [n, part] = GetParam();
  std::vector<int> wishes(n, 1);
  Summary summary;
  int number = 0;
  while (true) {
    bool least = true;
    for (int turn = 1; turn < n && least; ++turn)
      for (int i = 0; i < n; ++i) {
        const int a = wishes[(turn + i) % n];
        if (a == wishes[i]) continue;
        least = a > wishes[i];
        break;
      }
    if (least && (n < 12 || number++ % kParts == part)) {
      const DiskLayout layout = fill_disk(wishes);
      ASSERT_TRUE(is_good(wishes, layout));
      summary.add(wishes, layout);
    }
    int i = 0;
    while (i < n && wishes[i] == 3) wishes[i++] = 1;
    if (i == n) break;
    ++wishes[i];
  }
  EXPECT_GT(summary.layouts, 0);
  // Most wishes can be kept, with hardly more irregular nodes than there must be.
  EXPECT_GT(2 * summary.kept, summary.layouts);
  EXPECT_LT(4 * summary.irregular, 5 * summary.least);
  summary.record();
}

std::vector<std::pair<int, int>> all_patterns() {
  std::vector<std::pair<int, int>> result{{4, 0}, {6, 0}, {8, 0}, {10, 0}};
  for (int part = 0; part < kParts; ++part) result.emplace_back(12, part);
  return result;
}

INSTANTIATE_TEST_SUITE_P(DiskLayout, AllPatterns, testing::ValuesIn(all_patterns()),
                         [](const auto& info) { return std::to_string(info.param.first) + "_nodes_" + std::to_string(info.param.second); });

enum class Pattern { Any, MostlyStraight, FewCorners };

class RandomPatterns : public testing::TestWithParam<Pattern> {};

TEST_P(RandomPatterns, HaveGoodLayouts) {
  std::mt19937 random(1);
  Summary summary;
  for (int k = 0; k < 400; ++k) {
    const int n = 4 + 2 * static_cast<int>(random() % 29);
    std::vector<int> wishes(n, 2);
    if (GetParam() == Pattern::FewCorners) {
      for (int corners = static_cast<int>(random() % 7); corners > 0; --corners) wishes[random() % n] = 1;
    } else {
      for (int& q : wishes) {
        const int choice = static_cast<int>(random() % (GetParam() == Pattern::Any ? 3 : 12));
        q = choice == 0 ? 1 : choice == 1 ? 3 : 2;
      }
    }
    const DiskLayout layout = fill_disk(wishes);
    ASSERT_TRUE(is_good(wishes, layout));
    summary.add(wishes, layout);
  }
  EXPECT_LT(summary.irregular, 2 * summary.least);
  summary.record();
}

INSTANTIATE_TEST_SUITE_P(DiskLayout, RandomPatterns, testing::Values(Pattern::Any, Pattern::MostlyStraight, Pattern::FewCorners),
                         [](const auto& info) {
                           return info.param == Pattern::Any ? "Any" : info.param == Pattern::MostlyStraight ? "MostlyStraight" : "FewCorners";
                         });

TEST(DiskLayoutWithRing, JoinsNoTwoBoundaryNodesInside) {
  for (int n = 4; n <= 20; n += 2) {
    const DiskLayout layout = fill_disk_with_ring(n);
    EXPECT_EQ(find_defect(layout, n), "") << n;
    const std::vector<int> around = quads_around(layout, n);
    for (int k = 0; k < n; ++k) EXPECT_EQ(around[k], 2);
    for (std::size_t k = n; k < around.size(); ++k) EXPECT_TRUE(around[k] >= 3 && around[k] <= 6) << n;
    for (const auto& quad : layout.quads)
      for (int i = 0; i < 4; ++i) {
        const int a = quad[i], b = quad[(i + 1) % 4];
        EXPECT_TRUE(a >= n || b >= n || b == (a + 1) % n);
      }
  }
  for (const int bad : {-2, 0, 2, 3, 7}) EXPECT_THROW(fill_disk_with_ring(bad), Error);
}

// Hundreds of edges whose wishes contradict each other may take minutes.
TEST(DiskLayout, CanBeCancelled) {
  for (const int n : {6, 40, 400}) {
    std::vector<int> wishes;
    for (int i = 0; i < n; ++i) wishes.push_back(1 + (i * i + 3 * i) % 5 % 3);
    Context context;
    context.cancel();
    try {
      hybrid_mesh::fill_disk(wishes, Progress(context));
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::Cancelled);
    }
  }
}

}  // namespace
}  // namespace hybrid_mesh
