// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

enum class VertexPlaces {
  Nearest,
  OfMaps  // of a hierarchy whose vertices were put elsewhere than the surface is
};

// Where on the original surface the vertices of a hierarchy's meshes lie. A vertex's place in its map tells about where; but vertices are
// fitted to the surface and slide along it, so the place is the point of the maps' triangles closest to the vertex, unless that is on a
// sheet that faces the other way.
class VertexSources {
 public:
  explicit VertexSources(const HybridMesh& hierarchy, VertexPlaces places = VertexPlaces::Nearest);
  ~VertexSources();

  // #V; face -1 where there is no map. Not to be called from several threads at once: samplers remember where they were.
  std::vector<SurfacePoint> operator()(const HybridMesh& hierarchy, const QuadMesh& mesh) const;

 private:
  struct Pieces;
  std::unique_ptr<const Pieces> pieces_;
};

}  // namespace hybrid_mesh
