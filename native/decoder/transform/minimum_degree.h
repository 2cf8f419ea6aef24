// SPDX-License-Identifier: GPL-3.0-or-later
// Private to transform/.
#pragma once

#include <vector>

namespace hybrid_mesh {

// A symmetric matrix's pattern, column by column, the diagonal being there and rows ascending.
struct SymmetricPattern {
  std::vector<int> first{0};  // #columns + 1
  std::vector<int> row;
  int size() const { return static_cast<int>(first.size()) - 1; }
};

// An order of elimination that keeps fill low: the k-th pivot is result[k]. Ties are broken as Eigen 3.4's AMDOrdering breaks them, as which streams
// have been written with: another order would give other last bits.
std::vector<int> minimum_degree_order(const SymmetricPattern& pattern);

}  // namespace hybrid_mesh
