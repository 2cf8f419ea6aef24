// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parameterization/patch_map.h"
#include "parameterization/patched_surface.h"

namespace hybrid_mesh {

// A patched surface and where its faces' corners lie in their patch's unit square.
struct MappedSurface {
  PatchedSurface surface;
  std::vector<std::array<Vec2, 3>> corners;
};

// The inverse of extracting: joins maps of patches along their sides to one surface. `graph`: of the patches, one a map; the maps share the points
// along common sides. `repaired_faces` are the faces that the maps name as their source. Throws NoMap if two maps do not meet along a side.
MappedSurface glue_patch_maps(const std::vector<PatchMap>& maps, const QuadGraph& graph, const std::vector<std::array<int, 3>>& repaired_faces);

// The same without the faces that the maps name: the surface is its own source, point by point and face by face.
struct GluedMaps {
  MappedSurface mapped;
  std::vector<std::array<int, 3>> faces;  // that `mapped` names as its source: its own, and maybe further ones
  // Per such face where it lies on the surface that the maps name: as PatchMap has it.
  std::vector<int> source_face;
  std::vector<std::array<float, 9>> source;

  // Makes a map's sources, given in `faces`, name faces of the surface that the glued maps named.
  void trace(PatchMap& map) const;
  // Where the maps named faces of something between, makes them name what these lie on; per face of that as PatchMap has it.
  void trace_on(const std::vector<int>& between_face, const std::vector<std::array<float, 9>>& between);
};
GluedMaps glue_patch_maps(const std::vector<PatchMap>& maps, const QuadGraph& graph);

}  // namespace hybrid_mesh
