// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Guskov, Wood, Topological noise removal, 2001 (what is removed; not how it is found).
#include "topology/topological_noise.h"

#include <numeric>

namespace hybrid_mesh {

ClosedNoise close_noise(const TriangleSurface& surface, double length, const Progress& progress) {
  ClosedNoise closed;
  closed.surface = surface;
  closed.point_origin.resize(surface.points.size());
  std::iota(closed.point_origin.begin(), closed.point_origin.end(), 0);
  LoopOptions options;
  options.longest = length;
  options.detour = 1;
  // A cap may leave a shorter way around what is beside it.
  constexpr int rounds = 8;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<SurfaceLoop> loops = find_loops(closed.surface, {}, options, progress.part(round / 8.0, (round + 1) / 8.0));
    if (loops.empty()) break;
    std::vector<TopologyEvent> events;
    for (const SurfaceLoop& loop : loops) events.push_back({EventKind::Cut, {loop.points, {}}, loop.length, loop.kind});
    SurfaceSeries series = close_topology(closed.surface, std::move(events));
    progress.check();
    std::vector<int> origin;
    for (const int v : series.point_origin) origin.push_back(v < 0 ? -1 : closed.point_origin[v]);
    closed.point_origin = std::move(origin);
    closed.surface = std::move(series.closed);
    closed.handles += static_cast<int>(loops.size());
  }
  progress(1);
  return closed;
}

std::vector<TopologyEvent> find_boundary_events(const TriangleSurface& surface) {
  std::vector<TopologyEvent> events;
  for (std::vector<int>& loop : boundary_cycles(surface)) {
    const double length = cycle_length(surface, loop);
    events.push_back({EventKind::Boundary, {std::move(loop), {}}, length, LoopKind::Handle});
  }
  return events;
}

}  // namespace hybrid_mesh
