// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "topology/surface_series.h"

namespace hybrid_mesh {

// The events as close_topology() promises them, the faces that tubes hide, and the half-edges along loops. Throws as it does.
struct EventLoops {
  std::vector<TopologyEvent> events;
  std::vector<std::array<std::vector<int>, 2>> half_edges;  // per event and loop: from point i to the next, of the face at the left
  std::vector<std::array<std::vector<int>, 2>> hidden;
};
EventLoops locate_events(const TriangleSurface& surface, std::vector<TopologyEvent> events);

}  // namespace hybrid_mesh
