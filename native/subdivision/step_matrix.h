// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Sparse>
#include <vector>

#include "subdivision/catmull_clark.h"

namespace hybrid_mesh {

// The regular step N^{j-1} -> M^j as a matrix, wherever quads of N^{j-1} are refined. Adaptive hierarchies need not be continued for it: leaves that
// touch differ by at most one level, so that all quads around a refined one are there, whole. Sides on features are infinitely sharp creases.
struct StepMatrix {
  std::vector<int> refined;    // quads of N^{j-1}, as nodes of the hierarchy
  std::vector<VertexId> fine;  // rows: corners of these quads' children; first their own corners, then midpoints of their sides, then their centres
  int corners = 0, midpoints = 0;                        // how many of each
  std::vector<int> parent;                               // #corners: the column of the vertex itself
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights;  // columns: vertices of N^{j-1}
};

// `coarse` is the hierarchy's level j - 1, however closed.
StepMatrix step_matrix(const HybridMesh& hierarchy, const QuadMesh& coarse, int level, BoundaryRule boundary);

}  // namespace hybrid_mesh
