// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

namespace hybrid_mesh {

// For each vertex a list of others, ascending and each of them once, one list behind the other: that of i is column[row[i]] to column[row[i + 1] -
// 1].
struct CompressedRows {
  std::vector<int> row{0}, column;

  CompressedRows() = default;
  explicit CompressedRows(std::vector<std::vector<int>> lists) {
    for (std::vector<int>& list : lists) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      column.insert(column.end(), list.begin(), list.end());
      row.push_back(static_cast<int>(column.size()));
    }
  }
};

}  // namespace hybrid_mesh
