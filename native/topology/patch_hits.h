// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/closest_point.h"
#include "topology/loop_cap.h"

namespace hybrid_mesh {

// Where patches meet the surface that they are to join. Exact. Queries from several threads at once are safe; keeps a reference to the surface.
class PatchHits {
 public:
  PatchHits(const TriangleSurface& surface, const Progress& progress) : surface_(surface), query_(surface, progress) {}

  // How many triangles of the patch meet the surface elsewhere than at the corners and edges that they share with it. `rim` are the surface's points
  // that the patch's first ones are; faces in `hidden`, which is sorted, do not count. No more than `most` are counted.
  int count(const std::vector<int>& rim, const RimPatch& patch, const std::vector<int>& hidden, int most) const;

 private:
  const TriangleSurface& surface_;
  SurfaceDistanceQuery query_;
};

}  // namespace hybrid_mesh
