// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "parameterization/patch_map.h"
#include "parameterization/patched_surface.h"
#include "surface/placement.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// The repaired surface as the base domain and the maps are built on it: placed, and with its faces split in four where it has too few for the quads
// that are to be cut out of it (the same set of points).
struct WorkingSurface {
  TriangleSurface mesh;             // source_face: face of the repaired surface
  std::vector<PointSource> source;  // per point, in points of the repaired surface

  // Makes a map's sources, given in faces of `mesh`, name faces of the repaired surface.
  void to_repaired(PatchMap& map, const TriangleSurface& repaired) const;
};
WorkingSurface make_working_surface(const TriangleSurface& repaired, const Placement& placement, std::int64_t least_faces);

}  // namespace hybrid_mesh
