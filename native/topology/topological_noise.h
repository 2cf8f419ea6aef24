// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "topology/surface_series.h"

namespace hybrid_mesh {

// The surface without its small handles and tunnels.
struct ClosedNoise {
  TriangleSurface surface;        // source_face: -1 for caps
  std::vector<int> point_origin;  // per point: of the input, or -1 inside a cap
  int handles = 0;                // how many were cut
};

// Cuts and caps handles and tunnels whose loop is shorter than `length`, again and again until none is left. Those at boundaries stay.
ClosedNoise close_noise(const TriangleSurface& surface, double length, const Progress& progress);

// One event for each boundary loop.
std::vector<TopologyEvent> find_boundary_events(const TriangleSurface& surface);

}  // namespace hybrid_mesh
