// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "parameterization/chart_mesh.h"
#include "parameterization/patch_map.h"

namespace hybrid_mesh {

// Cuts a chart mesh along the integer lines of its charts: one map from the unit square a patch. Positions are rounded to a grid of 2^-40 first, so
// that all decisions are exact; neighbouring patches share the points along their side. `repaired_faces` are the faces that `surface` names as its
// source; a surface without points and faces stands for one whose are the charts' own, and these are the faces. Throws NoMap if the charts do not
// cover the patches once.
std::vector<PatchMap> extract_patch_maps(const ChartMesh& charts, const PatchedSurface& surface,
                                         const std::vector<std::array<int, 3>>& repaired_faces, const Progress& progress);

}  // namespace hybrid_mesh
