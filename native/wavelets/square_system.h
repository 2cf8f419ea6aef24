// SPDX-License-Identifier: GPL-3.0-or-later
// Private to wavelets/.
#pragma once

#include "wavelets/step_matrices.h"

namespace hybrid_mesh {

// Three numbers a row.
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

// matrix * x, in parallel, each row summed up in order.
Columns product(const SparseRows& matrix, const Columns& x);

// A sparse square system, as a rule well conditioned once its columns are scaled.
class SquareSystem {
 public:
  explicit SquareSystem(SparseRows matrix);

  struct Solution {
    Columns x;
    Columns residual;  // empty if none of its entries is larger than `accuracy` times the largest of the right side
  };
  // By conjugate gradients on the normal equations, from a guess: of a singular system a solution of least squares.
  Solution solve(const Columns& right, const Columns& guess, double accuracy) const;

 private:
  SparseRows matrix_, transposed_;  // columns scaled
  Eigen::VectorXd scale_;
};

}  // namespace hybrid_mesh
