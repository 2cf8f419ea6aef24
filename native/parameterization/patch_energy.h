// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {

// The energy of each patch's map beyond an isometry's, in patches of mean area. `scale`: of lengths, see ChartMesh; `theta`: see Distortion.
std::vector<double> patch_energies(const MappedSurface& mapped, double scale, double theta);

double map_energy(const PatchMap& map, double scale, double theta);
// The area of the surface under a map.
double map_area(const PatchMap& map);

}  // namespace hybrid_mesh
