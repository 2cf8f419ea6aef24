// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Bjoerck, Numerical methods for least squares problems, 1996, section 7.4 (CGLS).
#include "wavelets/square_system.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <utility>

namespace hybrid_mesh {

namespace {

// A well-conditioned system takes a hundred.
constexpr int most_steps = 1000;
// Of the residual, below which the gradient is rounding: the residual is what no solution takes away.
constexpr double vanished_gradient = 1e-13;
// How far below what is asked for the steps go on: the residual that they keep is not quite the true one.
constexpr double margin = 0.1;

}  // namespace

Columns product(const SparseRows& matrix, const Columns& x) {
  Columns result(matrix.rows(), 3);
  tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, matrix.rows(), 2048), [&](const tbb::blocked_range<Eigen::Index>& range) {
    for (Eigen::Index row = range.begin(); row < range.end(); ++row) {
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (SparseRows::InnerIterator entry(matrix, row); entry; ++entry) sum += entry.value() * x.row(entry.col());
      result.row(row) = sum;
    }
  });
  return result;
}

SquareSystem::SquareSystem(SparseRows matrix) : matrix_(std::move(matrix)), scale_(Eigen::VectorXd::Zero(matrix_.cols())) {
  for (Eigen::Index row = 0; row < matrix_.rows(); ++row)
    for (SparseRows::InnerIterator entry(matrix_, row); entry; ++entry) scale_[entry.col()] += entry.value() * entry.value();
  scale_ = scale_.cwiseSqrt().cwiseInverse();
  for (Eigen::Index row = 0; row < matrix_.rows(); ++row)
    for (SparseRows::InnerIterator entry(matrix_, row); entry; ++entry) entry.valueRef() *= scale_[entry.col()];
  transposed_ = matrix_.transpose();
}

SquareSystem::Solution SquareSystem::solve(const Columns& right, const Columns& guess, double accuracy) const {
  if (matrix_.rows() == 0) return {guess, {}};
  const double enough = accuracy * right.cwiseAbs().maxCoeff();
  Columns x = scale_.cwiseInverse().asDiagonal() * guess;
  Columns residual = right - product(matrix_, x);
  Columns gradient = product(transposed_, residual);
  Columns direction = gradient;
  double norm = gradient.squaredNorm();
  for (int step = 0; step < most_steps; ++step) {
    if (residual.cwiseAbs().maxCoeff() <= margin * enough) break;
    if (norm <= vanished_gradient * vanished_gradient * residual.squaredNorm()) break;
    const Columns image = product(matrix_, direction);
    const double length = norm / image.squaredNorm();
    x += length * direction;
    residual -= length * image;
    gradient = product(transposed_, residual);
    const double before = std::exchange(norm, gradient.squaredNorm());
    direction = gradient + norm / before * direction;
  }
  residual = right - product(matrix_, x);
  if (residual.cwiseAbs().maxCoeff() <= enough) residual.resize(0, 3);
  return {scale_.asDiagonal() * x, residual};
}

}  // namespace hybrid_mesh
