// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace hybrid_mesh {

// An edge of the dual graph: two faces that could form a quad (or face a alone with b = -1: across a boundary edge), and how good that is.
struct PairCandidate {
  int a, b;
  double weight;
};

// A perfect matching of largest weight of the faces 0 .. n - 1, in which a face may stay alone where it has a candidate with b = -1.
// Returns the index of the candidate chosen for each face. Throws NoMap if there is none.
std::vector<int> pair_triangles(int n, const std::vector<PairCandidate>& candidates);

}  // namespace hybrid_mesh
