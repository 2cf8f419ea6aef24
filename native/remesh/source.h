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
#include "surface/half_surface.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {

// What is remeshed, read and repaired once for all candidates. With symmetry there are two: the whole, which results are measured against, and its
// half, which is remeshed and then mirrored.
struct Source {
  std::size_t read_points = 0, read_polygons = 0;  // of the input
  TriangleSurface repaired;                        // where the input stands
  RepairReport repairs;
  int removed_handles = 0;   // of noise, see RemeshOptions::remove_noise
  TopologySummary topology;  // of `repaired`
  std::int64_t points = 0;   // of `repaired`; of a half: of it and its mirror image
  TopologySummary made;      // of the mesh that is to be made: that of `repaired`, or of the half and its mirror image
  // Of a half: the normal of the plane that it is mirrored in, which goes through the origin once placed, and where it is on the whole.
  std::optional<Vec3> mirror;
  std::shared_ptr<const HalfSurface> half;
  PlacedSurface placed() const { return {&repaired, placement}; }
  int copies() const { return mirror ? 2 : 1; }  // of `repaired` in the mesh that is made
  // Of the whole with symmetry: the half and its mirror image, of unit size, which is what the mesh is to be like.
  std::shared_ptr<const DistanceReference> symmetric;
  nlohmann::ordered_json symmetry;    // of the report; null: none was asked for
  Placement placement;                // that brings it to unit size
  double area = 0;                    // of unit size
  bool has_features = false;          // sharp edges of the kind that is asked for
  bool keeps_features = false;        // ... and is there room for them in the mesh that is asked for?
  bool features_are_crowded = false;  // ... but not much
  int feature_corners = 0;            // where they end, meet or turn
  bool has_inner_features = false;    // are some of them not on the boundary?
  Density density;                    // that quads are to have
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
  std::shared_ptr<const SizeField> need = {};  // sizes of quads as an earlier mesh has shown that the surface needs them; none: those of the source
  // What base and maps are made on, K^0, where the input stands.
  const TriangleSurface& surface() const { return base.closed ? *base.closed : source.repaired; }
  const std::shared_ptr<const SizeField>& sizes() const { return need ? need : source.density.sizes; }
};

// How sharp edges are found, as the options ask; none: they are not kept.
std::optional<FeatureOptions> feature_options(const Source& source, Features features, double angle);

// Looks for sharp edges of `repaired`.
void look_for_features(Source& source, const RemeshOptions& options);

// Throws Error{InvalidInput} where strict mode refuses repairs.
Source read_source(PolygonSoup input, const RemeshOptions& options, const Progress& progress, Stopwatch& watch);

}  // namespace hybrid_mesh
