// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/context.h"
#include "layout/base/base_domain.h"
#include "parameterization/global_map.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {

// A layout on a coarse version of a surface, and its map, which can be carried to finer versions, at last to the surface itself. Keeps a reference to
// the surface.
class CarriedMap {
 public:
  CarriedMap(const TriangleSurface& surface, CutSurface cut);

  // Undoes collapses until so many vertices are alive. The charts' triangles are then those of the surface so far, uncut, and their vertices and
  // faces its own; nothing happens where there is nothing to undo. Throws Error{Internal} where the map cannot be freed of the cuts, and then nothing
  // has changed.
  void carry(double vertices, const GlobalMapOptions& options, const Progress& progress);
  void quadrisect();
  // The coarse surface cut along the layout's sides as the map has them.
  MappedSurface cut(const Progress& progress) const;
  const std::vector<std::array<int, 3>>& faces() const { return faces_; }

  PatchedSurface layout;  // its points name vertices of the surface as their source, its faces those of the coarse version
  ChartMesh charts;       // on `layout.mesh`, or on the uncut coarse surface once it was carried

 private:
  const TriangleSurface& surface_;
  EditMesh collapsed_;
  std::vector<int> log_;                   // collapses that made the coarse version
  std::vector<std::array<int, 3>> faces_;  // of the coarse version, by number of the surface's face
};

}  // namespace hybrid_mesh
