// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Sparse>
#include <memory>
#include <vector>

#include "decoder/transform/level_step.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// The wavelet transform, one step N^{j-1} <-> N^j of the hierarchy: x_j = S x_{j-1} + W d. S is Catmull-Clark subdivision, W its quadrature mirror.
//
// What positions a level has: here, what analysis of the next finer level leaves of it, a low-pass of the final mesh; that is what a stream carries.
// A remesher's levels are another thing: each is fitted to the surface for itself, to be looked at, and is kept in the hierarchy
// (HybridMesh::set_level_positions). The transform neither reads nor writes those; it is given positions and returns some. Editing a level
// (level_editing.h) starts from the levels as they are shown.
//
// Vertices and their order are those of level_mesh(j - 1) and level_mesh(j). Of an adaptive hierarchy, what is not refined stays where it is, and S
// and W are those of the refined quads, with W cut off at their rim. Vertices that the closure of leaves makes are stored relative to the mean of
// their edge's ends or leaf's corners; a coarse mesh has them at that mean where the leaves that they close are refined in the fine one.
//
// Synthesis is the decoder's (LevelStep); analysis is its inverse.
//
// Irregular operations: vertices that they make are stored relative to the harmonic extension of their operation's boundary. Those that they take
// away have no positions to be analysed: their details are zero and not stored, and of N^{j-1}, those of them that it has lie in the mean of their
// neighbours.
struct LevelAnalysis {
  std::vector<Vec3> coarse;   // #vertices of N^{j-1}
  std::vector<Vec3> details;  // #WaveletStep::details(), in the directions of the coordinates
  // #vertices of N^j: what no coarse positions and details give. Empty as a rule: only where irregular vertices are side by side can subdivision
  // be singular (that of a cube takes a tetrahedron among its corners, moved one way, and the other, moved the other way, to nothing).
  std::vector<Vec3> remainder;
};

class WaveletStep {
 public:
  // Throws Error{InvalidInput} if the level is not in [1, depth].
  WaveletStep(const HybridMesh& hierarchy, int level, BoundaryRule boundary = BoundaryRule::EdgesOnly);
  ~WaveletStep();
  WaveletStep(WaveletStep&&) noexcept;
  WaveletStep& operator=(WaveletStep&&) noexcept;

  const QuadMesh& coarse() const;                    // N^{j-1}, with the hierarchy's positions
  const QuadMesh& fine() const;                      // N^j
  const std::vector<DetailVertex>& details() const;  // in the order of the fine mesh's vertices

  // From coarse to fine: local, in linear time. Throws Error{InvalidInput} if there are too few or too many, or any is not finite.
  std::vector<Vec3> synthesise(const LevelAnalysis& analysis) const;
  // The two halves of synthesis: where subdivision alone puts the fine vertices, and details and remainder added to that.
  std::vector<Vec3> subdivided(const std::vector<Vec3>& coarse) const;
  std::vector<Vec3> detailed(std::vector<Vec3> subdivided, const std::vector<Vec3>& details, const std::vector<Vec3>& remainder) const;
  // Its inverse, up to rounding: solves a sparse system. Throws Error{InvalidInput} in the same cases.
  LevelAnalysis analyse(const std::vector<Vec3>& fine) const;
  // Synthesis without a remainder as a matrix, #vertices of N^j x (#vertices of N^{j-1} + #details).
  Eigen::SparseMatrix<double, Eigen::RowMajor> synthesis() const;

 private:
  struct Parts;
  explicit WaveletStep(std::unique_ptr<const Parts> parts);
  friend std::vector<WaveletStep> wavelet_steps(const HybridMesh& hierarchy);

  std::unique_ptr<const Parts> parts_;
};

// To levels 1, 2, ..., depth.
std::vector<WaveletStep> wavelet_steps(const HybridMesh& hierarchy);

}  // namespace hybrid_mesh
