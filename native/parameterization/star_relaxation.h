// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/context.h"
#include "parameterization/chart_mesh.h"

namespace hybrid_mesh {

// Moves single vertices of a chart mesh to lower the map's distortion, their neighbours held.
class StarRelaxation {
 public:
  StarRelaxation(ChartMesh& charts, const Distortion& density) : c_(charts), density_(density) {}

  double face_energy(int f) const { return density_.of(c_.flat(f), c_.at(3 * f), c_.at(3 * f + 1), c_.at(3 * f + 2)); }

  // One Newton step on v's position, shortened until the energy falls and no triangle folds; with `lengthen` doubled as long as that gains.
  void relax(int v, bool lengthen);
  // The same for an energy that is finite for folded triangles: their determinant D is replaced by (D + sqrt(eps^2 + D^2)) / 2.
  void relax_folded(int v, double eps);
  // Relaxes the vertices around triangles of a determinant below `least`, until there are none or for so many sweeps: a line search over all vertices
  // would stall on them.
  void relax_squeezed(double least, int sweeps, const Progress& progress);
  // Every face counter-clockwise and no vertex but a cone wound around more than once.
  bool is_unfolded(const std::vector<int>& vertices) const;
  // Unfolds the stars of the given vertices by moving those of them that can move, in at most so many sweeps. Returns whether it did.
  bool unfold(const std::vector<int>& vertices, int sweeps = 24);
  std::int64_t relaxed_folded() const { return relaxed_folded_; }  // how often relax_folded() was called

 private:
  struct Spoke {
    Complex a, b;
    FlatTriangle t;  // corners: the vertex, a, b
  };
  struct Quadratic {
    double energy = 0;
    Eigen::Vector2d gradient{0, 0};
    Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
  };
  void gather(int v);
  template <class Density>
  Quadratic expand(const Complex& p, const Density& density) const;
  bool is_wound(int v) const;
  Complex newton_step(int v, Quadratic& q) const;
  double star_energy(const Complex& p) const;

  ChartMesh& c_;
  Distortion density_;
  std::vector<Spoke> star_;
  std::vector<Complex> line_;  // neighbours on the line on which the vertex slides
  std::int64_t relaxed_folded_ = 0;
};

}  // namespace hybrid_mesh
