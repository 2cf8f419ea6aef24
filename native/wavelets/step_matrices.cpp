// SPDX-License-Identifier: GPL-3.0-or-later
#include "wavelets/step_matrices.h"

#include <vector>

namespace hybrid_mesh {

SparseRows subdivision_matrix(const LevelPrediction& prediction) {
  const RefinedRows& rows = prediction.rows();
  SubdivisionMasks masks(prediction.quads(), prediction.coarse_count(), prediction.boundary());
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < rows.size(); ++row) {
    const int of = rows.source(row);
    const auto& mask = rows.is_corner(row) ? masks.vertex_mask(of) : rows.is_midpoint(row) ? masks.edge_mask(of) : masks.quad_mask(of);
    for (const auto& [vertex, weight] : mask) entries.emplace_back(row, vertex, weight);
  }
  SparseRows matrix(rows.size(), static_cast<Eigen::Index>(prediction.coarse_count()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

SparseRows wavelet_matrix(const LevelStep& step) {
  const RefinedRows& rows = step.prediction().rows();
  WaveletColumns columns = step.columns();
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = rows.corners(); column < rows.size(); ++column)
    columns.for_entries(column, [&](int row, double value) { entries.emplace_back(row, column, value); });
  SparseRows matrix(rows.size(), rows.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace hybrid_mesh
