// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// Counts over the used points, edges and polygons of any soup.
struct TopologySummary {
  std::int64_t vertices = 0, edges = 0, faces = 0;
  std::int64_t components = 0, boundary_loops = 0;
  std::int64_t nonmanifold_edges = 0, nonmanifold_vertices = 0, misoriented_edges = 0;
  std::int64_t euler = 0;
  double genus = 0;  // summed over the components; meaningful for oriented manifolds only
};

TopologySummary summarize_topology(const PolygonSoup& soup);
PolygonSoup to_soup(const TriangleSurface& surface);

}  // namespace hybrid_mesh
