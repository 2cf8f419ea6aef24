// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <cstdint>
#include <vector>

#include "bindings/vertex_sources.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// What is known of a hierarchy besides itself: of root quads, per node, what a remesh knows (as RemeshResult has it), nodes that came later being
// beyond the end of `opened`.
struct RootNotes {
  std::vector<int> plan_root;  // empty: there is no plan
  std::vector<int> opened;     // empty: nobody knows
  bool edited = false;         // levels were put elsewhere than the surface is

  int opened_at(int node) const { return node < static_cast<int>(opened.size()) ? opened[node] : -1; }
};

// A mesh of the hierarchy with what Blender shows of it.
struct AnnotatedMesh {
  QuadMesh mesh;
  std::vector<float> stretch;      // #F, see LevelStretch
  std::vector<float> anisotropy;   // #F
  std::vector<std::int32_t> root;  // #F: number of the root quad in a plan's addresses
  std::vector<std::int32_t> path;  // #F: 1, then the children from the root quad to the face's node as digits in base 4
  std::vector<bool> irregular;     // #F: under a root quad that an irregular operation made
  // #F: the event of the topology that opened where that root quad was put in, 1 for the plan's first one, and on which level; 0: none. Empty where
  // nobody knows
  std::vector<std::int32_t> opened, opened_level;
  std::vector<std::array<float, 2>> uv;              // #corners: patches as islands, side by side in a square grid
  std::vector<std::int32_t> source_face;             // #V: face of the repaired surface; -1 where the maps were dropped
  std::vector<std::array<float, 3>> source_weights;  // #V: barycentrics in it
};

// The numbers of root quads in addresses, per node. `plan_root`: see RootNotes; where there is no plan they are numbered in their order.
std::vector<int> root_numbers(const HybridMesh& hierarchy, const std::vector<int>& plan_root);

AnnotatedMesh annotate(const HybridMesh& hierarchy, const VertexSources& vertex_sources, const RootNotes& notes, QuadMesh mesh);
pybind11::dict to_dict(const AnnotatedMesh& annotated);

}  // namespace hybrid_mesh
