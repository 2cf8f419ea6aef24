// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "parameterization/chart_mesh.h"
#include "parameterization/face_sources.h"

namespace hybrid_mesh {

// Merges points that cutting has put into a surface into others, where the map allows it. The surface stays the same set of points: each face of the
// charts lies on a face of another surface, and what takes its place lies on the same. `sources`: where, per face of the charts; kept up to date.
void merge_inserted(ChartMesh& charts, const std::vector<char>& inserted, FaceSources& sources);

}  // namespace hybrid_mesh
