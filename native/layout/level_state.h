// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "layout/layout_edit.h"
#include "layout/layout_outline.h"
#include "parameterization/face_sources.h"
#include "parameterization/map_clipping.h"
#include "surface/placement.h"
#include "topology/surface_series.h"

namespace hybrid_mesh {

// Where a quad's map is: its own, or the part over its square of the map of the nearest ancestor that has one.
struct QuadMap {
  std::shared_ptr<const PatchMap> map;
  DyadicSquare square;
};

// The version of the surface that a level lies on, K^j.
struct SurfaceVersion {
  std::shared_ptr<const SurfaceSeries>
      series;              // in the maps' space, whose sources are its faces (see OpenedSurface::faces). None: it is one surface on all levels
  std::vector<bool> open;  // per event of it
};

// The state of one level that operations act on: its quads, and where each lies on the surface. Copies share the maps.
struct LevelState {
  QuadGraph quads;
  std::vector<QuadMap> maps;  // per quad
  double area = 0;            // of the surface where the maps have it; with sizes, in their metric
  Placement placement;        // that brings the maps to unit size: operations are as good wherever the surface stands and however large it is
  SurfaceVersion surface;
  std::shared_ptr<const SizeField> sizes;  // of quads, on the surface in unit size; none: they are to be even
};

// The next level, before any operation.
LevelState quadrisected(const LevelState& state);

// The places in `quads` of those of one map together, in the order in which their maps come: the same wherever these are in memory.
std::vector<std::vector<int>> grouped_by_map(const LevelState& state, const std::vector<int>& quads);

// The maps of some quads. Throws NoMap where rounding would fold one.
std::vector<PatchMap> maps_of(const LevelState& state, const std::vector<int>& quads);

// The maps of some quads by the triangles of those out of which they are cut: what lies in one of these was one triangle before.
// `roots`: these triangles, and where they lie on the surface.
std::vector<PatchMap> maps_of(const LevelState& state, const std::vector<int>& quads, FaceSources& roots);

// The quads of `part` alone, numbered in that order; nodes where the part merely touches itself are one.
QuadGraph part_of(const QuadGraph& graph, const std::vector<int>& part);

// An irregular operation that has been laid out and mapped, and waits to be applied.
struct MappedEdit {
  LayoutEdit edit;
  std::vector<int> opens;                      // events of the surface's series that open with it
  LayoutOutline outline;                       // of even quads: where they lie, the region's corners first among the nodes
  std::vector<std::pair<int, PatchMap>> maps;  // of the new quads, and of those around that were smoothed with them: by their numbers after the edit
  double energy_before = 0, energy_after = 0;  // of the maps of the region and of what was smoothed around it, beyond an isometry's, in quads
};

// Applies an edit to the quads and their maps.
LayoutChange apply(LevelState& state, const MappedEdit& mapped);

}  // namespace hybrid_mesh
