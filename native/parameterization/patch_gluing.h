// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "parameterization/face_sources.h"
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
  FaceSources on;                         // where such a face lies on the surface that the maps name
  std::vector<char> inserted;             // per point of `mapped` as it was glued: see PatchMap
};
GluedMaps glue_patch_maps(const std::vector<PatchMap>& maps, const QuadGraph& graph);

}  // namespace hybrid_mesh
