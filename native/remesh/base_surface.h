// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "layout/level_state.h"
#include "parameterization/patch_map.h"
#include "remesh/plan.h"
#include "remesh/remesh.h"
#include "surface/placement.h"
#include "surface/topology_summary.h"
#include "topology/surface_series.h"

namespace hybrid_mesh {

// What base and maps are made on, K^0: the repaired surface, with all of its topology closed that opens on a finer level.
struct BaseSurface {
  // Topology that found no room to open above the base, and why.
  struct Unopened {
    TopologyEvent event;
    std::string reason;
  };
  std::vector<Unopened> unopened;

  std::optional<TriangleSurface> closed;        // where the input stands; none where nothing opens late: then it is the repaired surface
  TopologySummary topology;                     // of the surface
  std::vector<int> levels;                      // per event of the series: on which it is to open, -1: the first that has room
  std::shared_ptr<const SurfaceSeries> series;  // of unit size; none where nothing opens late. Maps name faces of it, else those of the surface

  SurfaceVersion version() const;
  // Per face of the surface whether it is a cap's or tube's, or beside its rim, which has to stay; empty: none is.
  std::vector<char> held() const;
};

// What opens late.
struct LateEvent {
  TopologyEvent event;
  int level = -1;  // see BaseSurface::levels
};

BaseSurface base_surface(const TriangleSurface& repaired, const Placement& placement, const std::vector<LateEvent>& events);

// What is to open late, as the options ask.
std::vector<LateEvent> find_late_events(const TriangleSurface& repaired, const TopologySummary& topology, const RemeshOptions& options,
                                        const Progress& progress);
// The same as a plan says: its loops are the surface's own where it was made on this one, else cycles near them. Throws Error{InvalidInput} that
// names the event whose loop this surface does not have.
std::vector<LateEvent> late_events_of(const Plan& plan, const TriangleSurface& repaired, const Progress& progress);
// The events of a base surface, made on the repaired one, for a plan.
std::vector<Plan::Event> planned_events(const BaseSurface& base, const TriangleSurface& repaired);

// Makes the sources of a map, given in faces of a series, name faces of its input. What is on a cap or a tube names the point of the input beside it.
void name_input(PatchMap& map, const SurfaceSeries& series);

}  // namespace hybrid_mesh
