// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/context.h"
#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// So many sweeps of StarRelaxation::relax() over all vertices that can move, there and back in turn. On TBB's threads, with a result that does not
// depend on how many there are.
void relax_in_sweeps(ChartMesh& charts, const Distortion& density, int sweeps, const Progress& progress);

}  // namespace hybrid_mesh
