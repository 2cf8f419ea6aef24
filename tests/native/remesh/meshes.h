// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hierarchy/hybrid_mesh.h"
#include "surface/placement.h"

namespace hybrid_mesh::testing {

// A soup's polygons as a mesh, placed as a source is.
inline QuadMesh mesh_of(const PolygonSoup& soup, const Placement& placement = {}) {
  QuadMesh mesh;
  for (const Vec3& p : soup.points) mesh.points.push_back(placement.to_unit(p));
  mesh.offsets = soup.offsets;
  mesh.indices = soup.indices;
  return mesh;
}

}  // namespace hybrid_mesh::testing
