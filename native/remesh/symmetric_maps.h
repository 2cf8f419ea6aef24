// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "parameterization/patch_map.h"
#include "remesh/source.h"
#include "surface/closest_point.h"

namespace hybrid_mesh {

// Maps of a half made maps of the whole. Keeps references to both sources.
class SymmetricMaps {
 public:
  SymmetricMaps(const Source& whole, const Source& half);

  // A map of the half, and its mirror image with u and v exchanged. What is in the plane lies there exactly. Sources name faces of the whole's
  // repaired surface: of the map itself those that the half's are parts of, of the image those that are nearest.
  std::array<PatchMap, 2> operator()(const PatchMap& map) const;

 private:
  const Source& whole_;
  const Source& half_;
  TriangleSurface unit_;  // the whole's repaired surface, placed
  SurfaceDistanceQuery query_;
  MirrorPlane plane_;
};

}  // namespace hybrid_mesh
