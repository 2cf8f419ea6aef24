// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "remesh/fit.h"
#include "surface/size_field.h"

namespace hybrid_mesh {

// Points spread over the surface that a hierarchy's maps cover, each with its place in the map and the area it stands for: as many to every leaf's
// quad, however small it is.
class SurfaceSamples {
 public:
  // About `count` of them; leaves finer than level `finest` count as one of that level. `sizes`: of a level's quads, in the maps' space; none: they
  // are even.
  SurfaceSamples(const HybridMesh& hierarchy, std::int64_t count, int finest, const SizeField* sizes = nullptr);
  // Of these nodes' maps alone.
  SurfaceSamples(const HybridMesh& hierarchy, const std::vector<int>& owners, std::int64_t count, int finest, const SizeField* sizes = nullptr);
  // As samples of a mesh taken from the hierarchy, each with a face of the node that it lies under.
  std::vector<FitSample> on(const HybridMesh& hierarchy, const QuadMesh& mesh) const;
  std::size_t size() const { return samples_.size(); }

 private:
  struct Sample {
    Vec3 position, normal;
    double weight;
    MapLocation location;
  };
  std::vector<Sample> samples_;
};

// The triangles of all maps that count, each with points of its own: the surface that the leaves stand for.
PolygonSoup mapped_surface(const HybridMesh& hierarchy);

}  // namespace hybrid_mesh
