// SPDX-License-Identifier: GPL-3.0-or-later
// Hierarchies of all kinds: uniform and adaptive, with boundaries, sharp sides, operations.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <vector>

#include "subdivision/reference.h"

namespace hybrid_mesh {

inline double diagonal_of(const std::vector<Vec3>& points) {
  Eigen::AlignedBox<double, 3> box;
  for (const Vec3& point : points) box.extend(point);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

// The largest distance of points that should be the same, relative to the diagonal of the expected ones.
inline double farthest(const std::vector<Vec3>& points, const std::vector<Vec3>& expected) {
  EXPECT_EQ(points.size(), expected.size());
  double most = 0;
  for (std::size_t i = 0; i < points.size(); ++i) most = std::max(most, (points[i] - expected[i]).norm());
  return most > 0 ? most / diagonal_of(expected) : 0;
}

// Leaves of several levels.
inline HybridMesh refined_at_random(HybridMesh mesh, unsigned seed, int count) {
  std::mt19937 random(seed);
  for (int i = 0; i < count; ++i) {
    const std::vector<int> leaves = mesh.leaves();
    const int leaf = leaves[random() % leaves.size()];
    if (mesh.level(leaf) < 5) mesh.refine_balanced(leaf);
  }
  return mesh;
}

inline HybridMesh with_sharp_sides(HybridMesh mesh) {
  for (int i = 0; i < 4; ++i) mesh.set_sharp(0, i);
  mesh.set_sharp(1, 0);
  return mesh;
}

struct Hierarchy {
  std::string name;
  HybridMesh mesh;
};

inline std::vector<Hierarchy> hierarchies() {
  std::vector<Hierarchy> result;
  for (const Base& base : bases()) {
    HybridMesh uniform = base.mesh;
    uniform.refine_uniform(3);
    result.push_back({base.name, uniform});
    result.push_back({base.name + ", adaptive", refined_at_random(base.mesh, 1, 40)});
  }
  for (const HybridMesh& base : {cube(), grid(3, 2), torus(3, 3)}) {
    result.push_back({"operations", with_operations(base)});
    result.push_back({"operations, sharp sides", with_operations(with_sharp_sides(base))});
    HybridMesh adaptive = refined_at_random(with_operations(with_sharp_sides(base)), 2, 60);
    EXPECT_FALSE(adaptive.conforming());
    result.push_back({"operations, sharp sides, adaptive", adaptive});
    adaptive.set_closure(FaceClosure::Transition);
    result.push_back({"operations, sharp sides, adaptive, polygons", adaptive});
  }
  return result;
}

}  // namespace hybrid_mesh
