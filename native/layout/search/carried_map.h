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
  // Frees the map of the cuts: the charts' triangles are then those of the coarse surface, and their vertices and faces the surface's own; nothing
  // happens where the surface itself was cut. Throws NoMap where that cannot be done, and then nothing has changed.
  void uncut(const GlobalMapOptions& options, const Progress& progress);
  // The same, and undoes all collapses: the map is the surface's own then.
  void carry(const GlobalMapOptions& options, const Progress& progress);
  // The coarse surface cut along the layout's sides as the map has them.
  MappedSurface cut(const Progress& progress) const;
  const std::vector<std::array<int, 3>>& faces() const { return faces_; }

  PatchedSurface layout;  // its points name vertices of the surface as their source, its faces those of the coarse version
  ChartMesh charts;       // on `layout.mesh`, or on the uncut coarse surface once it was carried

 private:
  const TriangleSurface* surface_;
  bool is_cut_ = true;  // the charts' triangles are parts of the coarse surface's
  EditMesh collapsed_;
  std::vector<int> log_;                   // collapses that made the coarse version
  std::vector<char> sharp_;                // see CutSurface
  std::vector<std::array<int, 3>> faces_;  // of the coarse version, by number of the surface's face
};

}  // namespace hybrid_mesh
