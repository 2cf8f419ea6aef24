// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "base/context.h"
#include "remesh/base_surface.h"
#include "remesh/density.h"
#include "remesh/remesh.h"
#include "remesh/stopwatch.h"
#include "remesh/working_surface.h"
#include "surface/distance.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {

// What is remeshed, read and repaired once for all candidates.
struct Source {
  TriangleSurface repaired;  // where the input stands
  RepairReport repairs;
  int removed_handles = 0;      // of noise, see RemeshOptions::remove_noise
  TopologySummary topology;     // of `repaired`
  Placement placement;          // that brings it to unit size
  double area = 0;              // of unit size
  bool has_features = false;    // sharp edges of the kind that is asked for
  bool keeps_features = false;  // ... and is there room for them in the mesh that is asked for?
  int feature_corners = 0;      // where they end, meet or turn
  Density density;              // that quads are to have
  std::string fingerprint;
  std::unique_ptr<const DistanceReference> reference;  // the input as it was read, of unit size
};

// What every step of a remesh reads, and where it tells how far it is.
struct RemeshTask {
  const RemeshOptions& options;
  const Source& source;
  const BaseSurface& base;
  const Progress& progress;
  Stopwatch& watch;
};

// How sharp edges are found, as the options ask; none: they are not kept.
std::optional<FeatureOptions> feature_options(Features features, double angle);

// Throws Error{InvalidInput} where strict mode refuses repairs.
Source read_source(const PolygonSoup& input, const RemeshOptions& options, const Progress& progress, Stopwatch& watch);

}  // namespace hybrid_mesh
