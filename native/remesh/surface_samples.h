// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "remesh/fit.h"

namespace hybrid_mesh {

// Points spread evenly over the surface that a hierarchy's maps cover, each with its place in the map.
class SurfaceSamples {
 public:
  // About `count` of them.
  SurfaceSamples(const HybridMesh& hierarchy, std::int64_t count);
  // As samples of a mesh taken from the hierarchy, each with a face of the node that it lies under.
  std::vector<FitSample> on(const HybridMesh& hierarchy, const QuadMesh& mesh) const;
  std::size_t size() const { return samples_.size(); }

 private:
  struct Sample {
    Vec3 position, normal;
    MapLocation location;
  };
  std::vector<Sample> samples_;
};

}  // namespace hybrid_mesh
