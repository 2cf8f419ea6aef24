// SPDX-License-Identifier: GPL-3.0-or-later
// What holds for every remesh.
#pragma once

#include <gtest/gtest.h>

#include "remesh/remesh.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh::testing {

// The hierarchy has no defect, and the final mesh is a manifold of the repaired input's topology.
inline void expect_sound(const RemeshResult& r) {
  EXPECT_TRUE(find_defects(r.hierarchy).empty());
  const TopologySummary before = summarize_topology(to_soup(r.repaired)), after = summarize_topology(to_soup(r.final_mesh));
  EXPECT_EQ(after.nonmanifold_edges + after.nonmanifold_vertices + after.misoriented_edges, 0);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.boundary_loops, before.boundary_loops);
  EXPECT_EQ(after.genus, before.genus);
}

// All maps are bijective; see find_map_defect().
inline void expect_maps_without_defects(const HybridMesh& mesh) {
  for (int n = 0; n < mesh.node_count(); ++n)
    if (const PatchMap* map = mesh.map(n)) {
      EXPECT_STREQ(find_map_defect(*map), "") << n;
    }
}

}  // namespace hybrid_mesh::testing
