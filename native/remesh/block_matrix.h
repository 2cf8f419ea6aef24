// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "hierarchy/hybrid_mesh.h"
#include "remesh/compressed_rows.h"

namespace hybrid_mesh {

// Symmetric positive definite blocks of 3 x 3 between vertices that share a face.
struct BlockMatrix : CompressedRows {
  std::vector<Eigen::Matrix3d> block;  // per entry of `column`

  explicit BlockMatrix(const QuadMesh& mesh) : CompressedRows(sharing_faces(mesh)), block(column.size()) {}

  int find(int i, int j) const {
    return static_cast<int>(std::lower_bound(column.begin() + row[i], column.begin() + row[i + 1], j) - column.begin());
  }

 private:
  static std::vector<std::vector<int>> sharing_faces(const QuadMesh& mesh) {
    std::vector<std::vector<int>> lists(mesh.points.size());
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
        for (std::int64_t j = mesh.offsets[f]; j < mesh.offsets[f + 1]; ++j) lists[mesh.indices[i]].push_back(mesh.indices[j]);
    return lists;
  }
};

}  // namespace hybrid_mesh
