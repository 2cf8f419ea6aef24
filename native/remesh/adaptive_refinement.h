// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "base/context.h"
#include "base/limits.h"
#include "hierarchy/hybrid_mesh.h"
#include "surface/distance.h"
#include "surface/placement.h"
#include "surface/size_field.h"

namespace hybrid_mesh {

struct AdaptiveOptions {
  std::int64_t vertices = 0;          // hard upper bound on the mesh's vertices; 0 = as many as the error takes, up to four million
  double error = 0;                   // stop at this l2 (relative to the bounding-box diagonal); 0 = none
  int deepest = limits::most_levels;  // finest level of a leaf
  // Of quads, in the maps' space: where these are to be smaller, errors count more. None: errors count the same everywhere.
  const SizeField* sizes = nullptr;
  PlacedSurface surface;  // see SurfaceFitOptions
  // Of half a mesh, to be joined with its mirror image along its marked sides: see HalfSurface. Vertices are then those of both.
  std::optional<int> cut_euler;
};

// The vertices of the mesh of a hierarchy's leaves, closed as the hierarchy says.
std::int64_t closed_vertices(const HybridMesh& hierarchy);

// Refines a hierarchy of base quads, each with its map, where that brings the mesh of its leaves closest to the surface, and returns that mesh:
// closed as the hierarchy's closure says and fitted to the surface. Leaves are balanced (HybridMesh::refine_balanced). `surface` is the input in
// the coordinates of the maps.
//
// Without an error bound, at least 98 % of the vertices allowed are used, unless leaves of level `deepest` do not suffice or no sequence of splits
// leads there (where closure splits every leaf, no mesh has a number between that of the base and four times as many).
// With one, the mesh meets it, as DistanceReference::distance() with its default options measures it, with nearly the fewest vertices that refinement
// needs for it; if the vertices allowed do not suffice, they are used and the bound is missed, which is for the caller to see. Throws
// Error{InvalidInput} if the hierarchy as it is has more vertices than are allowed.
QuadMesh refine_adaptively(HybridMesh& hierarchy, const DistanceReference& surface, const AdaptiveOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
