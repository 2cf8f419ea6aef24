// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/context.h"
#include "surface/closest_point.h"
#include "surface/needle_regions.h"
#include "surface/triangle_surface.h"

namespace hybrid_mesh {

// Lengths are those of the surface, which is meant to be of unit size.
struct WellShapedOptions {
  double longest_edge = 0.01;   // longer edges are split; with the surface's sizes, those of them in whose metric they are longer
  double shortest_edge = 5e-4;  // no edge is split into shorter ones: what is left of bad triangles where the shape asks for more
  double collapsible = 0.006;   // edges of bad triangles that are shorter than this may go
  double tolerance = 1e-5;      // distance that the surface may move; far below the error of what is made from it
  double least_angle = 22;      // degrees; triangles with a smaller one are bad. Above 25 the refinement may not end before the points do
  // The same beside edges that are held because the surface bends there: the strips of a tube or fillet, of which there may be many.
  double least_bent_angle = 12;
  double sharp_angle = 30;             // degrees between normals; such edges are features, whose points move along them only
  NeedleOptions needles;               // where triangles are mended
  std::vector<char> held;              // per face of the input, or none: faces that are not, whatever their shape
  double small_corner = 60;            // degrees; where features meet at less, their splits keep the same distances from the corner
  std::int64_t most_points = 1000000;  // no point is added beyond
};

struct WellShaped {
  TriangleSurface mesh;                               // source_face: a face of the input that is closest to the face's centroid
  std::vector<SurfacePoint> place;                    // per point, on the input
  bool unchanged = false;                             // points and faces are the input's, in its order
  std::shared_ptr<const SurfaceDistanceQuery> query;  // of the input, if it was needed
};

// A triangulation of the same surface, within the tolerance, whose triangles are not too large, and well shaped where there are needles. Elsewhere
// faces of the input stay as they are, or are split, and so do they where they are well shaped. There edges are flipped and collapsed where that
// moves the surface by no more than the tolerance, measured against the input; what these cannot mend is refined. Boundaries and sharp edges stay
// curves of edges. Angles below the least one are left where the input forces them (at a corner between two edges that cannot be flipped) and where
// edges would get too short or points too many.
WellShaped make_well_shaped(const TriangleSurface& input, const WellShapedOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
