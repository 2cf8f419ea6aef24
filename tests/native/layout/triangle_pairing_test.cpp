// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/triangle_pairing.h"

#include <gtest/gtest.h>

namespace hybrid_mesh {
namespace {

TEST(TrianglePairing, TakesTheHeavierOfTwoPerfectMatchings) {
  // A square of four faces.
  const std::vector<PairCandidate> candidates{{0, 1, 1}, {1, 2, 3}, {2, 3, 1}, {3, 0, 3}};
  const std::vector<int> choice = pair_triangles(4, candidates);
  EXPECT_EQ(choice, (std::vector<int>{3, 1, 1, 3}));
}

TEST(TrianglePairing, AnOddFaceStaysAloneWhereItMay) {
  const std::vector<PairCandidate> candidates{{0, 1, 1}, {1, 2, 1}, {0, -1, -10}, {2, -1, -5}};
  const std::vector<int> choice = pair_triangles(3, candidates);
  EXPECT_EQ(choice, (std::vector<int>{0, 0, 3}));
}

}  // namespace
}  // namespace hybrid_mesh
