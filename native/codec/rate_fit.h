// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// What details cost beside distances. Everything is a mean square, in units of the surface's diagonal: of the samples' distances, of the details
// (scaled by what they do to the final mesh's vertices) over its vertices.
struct RateFitOptions {
  double along_surface = 0.02;   // weight of a sample's distance along the surface against that along its normal
  double across_details = 1e-3;  // of the details' components along normals
  double along_details = 0.3;    // ... and along the surface, which do next to nothing for its shape
  double large_along = 1e-3;     // these grow as the logarithm of their square beyond this
  double coarser = 0.5;          // of what a level's details cost, those of the next coarser one: there are a quarter as many of them
  double caution = 0.02;         // of a round's changes, along and across
  double sparse = 0.6e-4;        // a detail well below this costs twice its square, one well above twice the square of this: few are between
  int coarse_rounds = 2;         // with the details of some of the levels
  int rounds = 6;                // with all of them; each finds closest points anew
  int free_rounds = 2;           // of these, before places that have gone astray start anew from where they were
  double last = 0.1;             // times what details cost, in the last round: small ones are never sent unless they are asked for
  int iterations = 35;           // of conjugate gradients a round
  std::int64_t samples = 12;     // a vertex, of the surface
};

// Moves the vertices of a hierarchy's final mesh to where it comes as close to a surface as before with details that cost fewer bits in a stream:
// coarse levels lie as close as they can, and details are along normals, and few. Where that leads away from the surface, vertices start anew from
// where they were. Vertices on boundaries and sharp sides stay near where they are. `surface` has polygons that the final mesh lies near. Returns the
// final mesh. Throws Error{InvalidInput} if the surface has no area. Based on: Guskov, Vidimce, Sweldens, Schroeder, Normal meshes, 2000 (details
// along normals); here by least squares on the coefficients.
QuadMesh fit_for_rate(const HybridMesh& hierarchy, const PolygonSoup& surface, const RateFitOptions& options, const Progress& progress);

// Whether the final mesh is one of this surface: no point of that is farther from it than its faces are large there. An edited mesh is not.
bool lies_on(const QuadMesh& mesh, const PolygonSoup& surface, const Progress& progress);

}  // namespace hybrid_mesh
