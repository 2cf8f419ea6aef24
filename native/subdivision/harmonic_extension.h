// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Sparse>
#include <array>
#include <vector>

#include "decoder/transform/harmonic_extension.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// Makes every value that is not known the mean of its neighbours', along the edges between vertices that take part. Values without a path to a known
// one stay as they are and are counted.
int extend_harmonically(const std::vector<std::array<int, 2>>& edges, const std::vector<Known>& known, std::vector<Vec3>& values);
// The same as a matrix, #is_known x #is_known: known values are themselves, those without a path to a known one and absent ones are zero.
Eigen::SparseMatrix<double, Eigen::RowMajor> harmonic_extension(const HarmonicExtension& extension, const std::vector<char>& is_known);

}  // namespace hybrid_mesh
