// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of irregular operations ask of a hierarchy.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "hierarchy/brute_force.h"
#include "hierarchy/irregular_operations.h"

namespace hybrid_mesh {

// For each corner of a region the number of quads inside that makes it regular: four around it with those outside, two on the mesh's boundary; at
// least one.
inline std::vector<int> regular_quads(const DiskRegion& region) {
  std::vector<int> result;
  for (std::size_t k = 0; k < region.corners.size(); ++k) result.push_back(std::max(1, (region.on_mesh_boundary[k] ? 2 : 4) - region.outside[k]));
  return result;
}

inline testing::AssertionResult sound(const HybridMesh& mesh) {
  const auto defects = find_defects(mesh);
  if (!defects.empty()) return testing::AssertionFailure() << defects.size() << " defects, first: " << defects[0];
  const std::string wrong = find_wrong_answer(mesh);
  if (!wrong.empty()) return testing::AssertionFailure() << "wrong answer: " << wrong;
  return testing::AssertionSuccess();
}

// The same, but leaves may differ by any number of levels.
inline testing::AssertionResult sound_but_for_balance(const HybridMesh& mesh) {
  for (const std::string& defect : find_defects(mesh))
    if (defect.find("levels' difference") == std::string::npos && defect.find("has finer neighbours on") == std::string::npos)
      return testing::AssertionFailure() << "a defect: " << defect;
  const std::string wrong = find_wrong_answer(mesh);
  if (!wrong.empty()) return testing::AssertionFailure() << "wrong answer: " << wrong;
  return testing::AssertionSuccess();
}

inline std::vector<int> active_of_level(const HybridMesh& mesh, int level) {
  std::vector<int> result;
  for (int n = 0; n < mesh.node_count(); ++n)
    if (mesh.is_active(n) && mesh.level(n) == level && !mesh.is_root(n)) result.push_back(n);
  return result;
}

// Everything that the hierarchy tells of itself.
inline std::vector<std::int64_t> everything(const HybridMesh& mesh) {
  std::vector<std::int64_t> result{mesh.node_count(), mesh.operation_count(), mesh.leaf_counts().vertices, mesh.leaf_counts().hanging,
                                   mesh.leaf_counts().euler};
  for (int n = 0; n < mesh.node_count(); ++n) {
    for (std::int64_t x : {mesh.level(n), mesh.parent(n), mesh.first_child(n), mesh.root(n), mesh.inserted_by(n), mesh.removed_by(n),
                           static_cast<int>(mesh.is_active(n))})
      result.push_back(x);
    for (int s = 0; s < 4; ++s) {
      const SideLink other = mesh.neighbour(n, s);
      for (std::int64_t x : {mesh.half_edge(n, s), mesh.corner(n, s).code, other.node, other.side}) result.push_back(x);
    }
  }
  for (int o = 0; o < mesh.operation_count(); ++o) {
    result.push_back(mesh.operation(o).enabled);
    for (int d : mesh.operation(o).depends) result.push_back(d);
  }
  return result;
}

}  // namespace hybrid_mesh
