// SPDX-License-Identifier: GPL-3.0-or-later
// Private to wavelets/.
#pragma once

#include <Eigen/Sparse>

#include "decoder/transform/level_step.h"

namespace hybrid_mesh {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// S of a step, #rows x #vertices of N^{j-1}: rows are RefinedRows.
SparseRows subdivision_matrix(const LevelPrediction& prediction);

// W of a step, #rows x #rows: a column for every midpoint and centre; those of corners are empty.
SparseRows wavelet_matrix(const LevelStep& step);

}  // namespace hybrid_mesh
