// SPDX-License-Identifier: GPL-3.0-or-later
// Private to wavelets/.
#pragma once

#include "subdivision/step_matrix.h"

namespace hybrid_mesh {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// W of a step, #fine x #fine in the order of StepMatrix::fine: a column for every midpoint and centre; those of corners are empty. Where subdivision
// is that of tensor-product cubic splines, the columns are orthogonal to those of S. Entries of a column are in no order.
struct WaveletFilters {
  struct Entry {
    int row = -1;
    double value = 0;
  };
  std::vector<std::size_t> first{0};  // #fine + 1: where a column's entries start
  std::vector<Entry> entries;
};

WaveletFilters wavelet_filters(const HybridMesh& hierarchy, const StepMatrix& step);

}  // namespace hybrid_mesh
