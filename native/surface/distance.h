// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "base/context.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// Distances between two surfaces as the Metro tool defines them, all relative to the bounding-box diagonal of the first.
struct SurfaceDistance {
  double l2 = 0, l2_ab = 0, l2_ba = 0;  // root mean square; l2 is the larger of the two directions
  double mean = 0;                      // larger direction
  double hausdorff = 0;                 // the larger direction; reached by a point, and the true one is at most 1 % larger
  double hausdorff_bound = 0;           // the true one is not larger; more than 1 % above `hausdorff` only where finding out would take too long
  double boundary_hausdorff = -1;       // the same as `hausdorff` between the boundary curves; -1 where one surface is closed
  double diagonal = 0;                  // of the first, absolute
  // The points that `hausdorff` and `boundary_hausdorff` are reached by, of either surface, where the surfaces stand.
  Vec3 farthest = Vec3::Zero(), boundary_farthest = Vec3::Zero();
};

struct DistanceOptions {
  std::int64_t samples = 200000;  // a direction, stratified by area
  std::uint64_t seed = 1;
};

// A surface that others are measured against. Holds a copy of what it needs; calls from several threads at once are safe.
class DistanceReference {
 public:
  // Throws Error{InvalidInput} if the surface has no area.
  explicit DistanceReference(const PolygonSoup& surface);
  // Distances are fractions of another diagonal than the surface's own: of a whole that it is a part of.
  DistanceReference(const PolygonSoup& surface, double diagonal);
  ~DistanceReference();

  // The means are of area-weighted samples in both directions; the Hausdorff distances are found by branch and bound (see
  // one_sided_hausdorff.h), since samples miss the top of a thin maximum, 200,000 of them by up to a quarter.
  // In parallel; the result does not depend on the number of threads. Polygons are split by triangulate().
  // Throws Error{InvalidInput} if the other surface has no area.
  SurfaceDistance distance(const PolygonSoup& other, const DistanceOptions& options, const Progress& progress) const;

 private:
  class Prepared;
  std::unique_ptr<const Prepared> prepared_;
};

// The same for one pair.
SurfaceDistance surface_distance(const PolygonSoup& a, const PolygonSoup& b, const DistanceOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
