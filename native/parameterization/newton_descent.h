// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/context.h"
#include "parameterization/chart_mesh.h"

namespace hybrid_mesh {

// The numbers without a unit are ratios; an energy is that of all triangles.
struct NewtonOptions {
  int steps = 15;               // at most
  double converged = 1e-5;      // the share of the energy that a step must gain to be followed by another one
  double to_boundary = 0.9;     // of the way to where the first triangle vanishes, which a step takes at most: the barrier is infinite there
  double sufficient = 1e-4;     // of the gain that the slope promises, which a step must have (Armijo's rule)
  int halvings = 25;            // of a step; beyond 2^-25 of the first length it is lost in rounding
  double ridge = 1e-10;         // of its triangles' area, added to the Hessian for each corner: a projected Hessian may be singular
  double damping = 1e-6;        // of its diagonal, added where it is not positive definite all the same, and ...
  double damping_growth = 100;  // ... times this where that is not enough ...
  int dampings = 4;             // ... so many times: the diagonal is then doubled, and the step no better than a gradient's
};

// Newton steps on all vertices' positions at once, with Hessians that are projected triangle by triangle; no step folds a triangle. Returns how many
// were made.
int newton_descent(ChartMesh& charts, const Distortion& density, const NewtonOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
