// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/context.h"
#include "layout/base/base_domain.h"
#include "parameterization/global_map.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {

// A layout on a coarse version of a surface, and its map, which can be carried to finer versions, at last to the surface itself. Keeps a pointer to
// the surface.
class CarriedMap {
 public:
  CarriedMap(const TriangleSurface& surface, CutSurface cut);

  // Takes another layout of the coarse surface, cut along it, and its map.
  void replace(PatchedSurface cut_layout, ChartMesh cut_charts);
  // Frees the map of the cuts and undoes all collapses: the charts' vertices and faces are then the surface's own. Nothing happens where the surface
  // itself was cut. Throws NoMap where it cannot be done. Either way nothing else can be done with it afterwards: what it took is free.
  void carry(const GlobalMapOptions& options, const Progress& progress);
  // The coarse surface cut along the layout's sides as the map has them.
  MappedSurface cut(const Progress& progress) const;
  const std::vector<std::array<int, 3>>& faces() const { return faces_; }

  PatchedSurface layout;  // its points name vertices of the surface as their source, its faces those of the coarse version; none once it was carried
  ChartMesh charts;       // on `layout.mesh`, or on the surface once it was carried

 private:
  const TriangleSurface* surface_;
  EditMesh collapsed_;
  std::vector<int> log_;                   // collapses that made the coarse version
  std::vector<char> sharp_;                // see CutSurface
  std::vector<std::array<int, 3>> faces_;  // of the coarse version, by number of the surface's face
};

}  // namespace hybrid_mesh
