// SPDX-License-Identifier: GPL-3.0-or-later
// Private to codec/.
#pragma once

#include <Eigen/Sparse>
#include <array>
#include <vector>

#include "wavelets/wavelet_step.h"

namespace hybrid_mesh {

// Three numbers a row.
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

// All steps of a hierarchy's synthesis as one linear map, from the base's points and all details, these in frames of their own, to the points of the
// final mesh. Coefficients are scaled by their weights, so that of each the same change means about as much.
class LevelChain {
 public:
  using Axes = std::array<Vec3, 3>;  // of a frame
  explicit LevelChain(const HybridMesh& hierarchy);

  int depth() const { return static_cast<int>(steps_.size()); }
  // The base's points and, of every level from 1 on, the details' scaled components. Rows: part 0, part 1, ...
  Eigen::Index part(int level) const { return first_[level]; }  // its first row; of level depth() + 1: how many rows there are
  Eigen::Index rows() const { return first_.back(); }

  // What analysis of the final mesh's points gives; sets the frames. A remainder is left out.
  Columns analyse(const std::vector<Vec3>& points);
  // Turns the frames to where these coefficients put the levels, and gives the same details by the new ones.
  Columns reframed(const Columns& coefficients);

  std::vector<Vec3> synthesise(const Columns& coefficients) const;
  Columns product(const Columns& coefficients) const;
  Columns transposed_product(const Columns& points) const;

  // Whether components 1 and 2 of a row are along the surface, where vertices may slide.
  bool slides(Eigen::Index row) const { return slides_[row]; }

 private:
  Columns details_of(const Columns& coefficients, int level) const;
  void set_frames(int level, const std::vector<Vec3>& subdivided);

  std::vector<WaveletStep> steps_;
  std::vector<Eigen::SparseMatrix<double, Eigen::RowMajor>> matrix_, transposed_;
  std::vector<Eigen::Index> first_;
  std::vector<double> weight_;  // #rows
  std::vector<char> slides_;    // #rows
  std::vector<Axes> frames_;    // #rows
};

}  // namespace hybrid_mesh
