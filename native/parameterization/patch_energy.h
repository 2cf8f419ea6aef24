// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {

// The energy of each patch's map beyond an isometry's, in patches of mean area. `scale`: of lengths, see ChartMesh; `theta`: see Distortion.
std::vector<double> patch_energies(const MappedSurface& mapped, double scale, double theta);

// Of one map. `sizes`: of quads on the surface, in the space where the maps have it; none: they are to be even.
double map_energy(const PatchMap& map, double scale, double theta, const SizeField* sizes = nullptr);
// The area of the surface under a map.
double map_area(const PatchMap& map, const SizeField* sizes = nullptr);

}  // namespace hybrid_mesh
