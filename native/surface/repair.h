// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/context.h"
#include "surface/polygon_soup.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

struct RepairOptions {
  double drop_components = 0;  // components with less than this fraction of the whole area are removed; 0 = none
};

// How much of each kind was changed; all zero for a clean input.
struct RepairReport {
  std::int64_t merged_points = 0;     // points at the same position as an earlier one, but for rounding
  std::int64_t isolated_points = 0;   // points without a face
  std::int64_t duplicate_faces = 0;   // left out; both of a pair of opposite faces where one alone would open a surface
  std::int64_t degenerate_faces = 0;  // two corners coincide, or no area: left out, or flipped where leaving out would open a crack
  std::int64_t reoriented_faces = 0;
  std::int64_t nonmanifold_edges = 0;     // edges of more than two faces, cut apart
  std::int64_t nonmanifold_vertices = 0;  // points at which parts of the surface touch that share no edge there, cut apart
  std::int64_t one_sided_cuts = 0;        // edges along which a one-sided component was cut open
  std::int64_t dropped_components = 0;
  bool changed() const;
};

// Makes an oriented 2-manifold of a polygon soup by combinatorial means alone: no point moves, no hole is filled.
// Polygons are triangulated first (source_face counts those triangles). The result is simplicial: no two faces share
// all corners and no two edges share both ends. Throws Error{InvalidInput} if no face is left.
TriangleSurface repair(const PolygonSoup& soup, const RepairOptions& options, RepairReport& report, const Progress& progress);

}  // namespace hybrid_mesh
