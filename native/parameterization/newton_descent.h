// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/context.h"
#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// At most so many Newton steps on all vertices' positions at once, each shortened until the energy falls and no triangle folds. Returns how many were
// made.
int newton_descent(ChartMesh& charts, const Distortion& density, int steps, const Progress& progress);

}  // namespace hybrid_mesh
