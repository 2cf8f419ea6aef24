// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Symmetric positive definite blocks of 3 x 3 between vertices that share a face, in compressed rows.
struct BlockMatrix {
  std::vector<int> row, column;
  std::vector<Eigen::Matrix3d> block;

  explicit BlockMatrix(const QuadMesh& mesh) {
    const int n = static_cast<int>(mesh.points.size());
    std::vector<std::vector<int>> neighbours(n);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
        for (std::int64_t j = mesh.offsets[f]; j < mesh.offsets[f + 1]; ++j) neighbours[mesh.indices[i]].push_back(mesh.indices[j]);
    row.push_back(0);
    for (std::vector<int>& list : neighbours) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      column.insert(column.end(), list.begin(), list.end());
      row.push_back(static_cast<int>(column.size()));
    }
    block.resize(column.size());
  }
  int find(int i, int j) const {
    return static_cast<int>(std::lower_bound(column.begin() + row[i], column.begin() + row[i + 1], j) - column.begin());
  }
};

}  // namespace hybrid_mesh
