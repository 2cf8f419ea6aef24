// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "topology/surface_series.h"

namespace hybrid_mesh {

// Tubes that join the components of a surface to one: short ones between points whose normals face each other, around which the surface gives its
// place to them, that meet neither the surface nor each other where there are any. They keep off the points of `others`. A component all of whose
// points are beside a boundary or on the others' loops stays apart.
std::vector<TopologyEvent> find_tubes(const TriangleSurface& surface, const std::vector<TopologyEvent>& others, const Progress& progress);

}  // namespace hybrid_mesh
