// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hierarchy/hybrid_mesh.h"
#include "remesh/fit.h"
#include "surface/placement.h"
#include "surface/size_field.h"

namespace hybrid_mesh {

struct SurfaceFitOptions {
  FitOptions first;                  // the fit that comes first
  int turns = 2;                     // of angle relaxation and fit after it
  int finest = 64;                   // leaves finer than this level count as one of it, as in a mesh of that level
  const SizeField* sizes = nullptr;  // of the quads, in the maps' space; none: those of a level are even
  bool apart = false;                // faces that run through one another are taken apart, and fitted once more from there
  PlacedSurface surface;             // ... but where this one runs through itself as well; none: it does nowhere
  double unfold = 1.0;               // how far folded quads' vertices may go at the end, in lengths of their shortest edge
};

// The samples that a mesh of so many vertices is fitted to.
std::int64_t fit_sample_count(std::size_t vertices);

// The parameter area of the quads around each vertex of a mesh taken from the hierarchy: the `share` of fit_mesh. With sizes, as much of the
// surface as quads of these sizes cover.
std::vector<double> parameter_shares(const HybridMesh& hierarchy, const QuadMesh& mesh, const SizeField* sizes = nullptr);

// Moves the vertices of a mesh, all but those of its boundary, to where it comes closest to the samples while its quads keep their shape. Lengths are
// of a surface of unit size. `share`: see fit_mesh().
void fit_to_samples(QuadMesh& mesh, std::vector<FitSample> samples, const std::vector<double>& share, const SurfaceFitOptions& options,
                    const Progress& progress);

// Moves the vertices of a mesh taken from the hierarchy, all but those of the boundary, to where the mesh comes closest to the surface under the
// hierarchy's maps while its quads keep their shape.
void fit_to_surface(QuadMesh& mesh, const HybridMesh& hierarchy, const SurfaceFitOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
