// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "base/context.h"
#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// Pairs of a mesh's faces, the lower one first, that meet elsewhere than at the vertices that they share, and the middle of where they first meet.
// Faces are split into triangles by triangulate().
using CrossingFaces = std::map<std::pair<int, int>, Vec3>;
CrossingFaces crossing_faces(const QuadMesh& mesh, const Progress& progress);

// Takes out of a mesh's crossing faces those that are right as they are.
using CrossingFilter = std::function<void(const QuadMesh&, CrossingFaces&)>;

// Where faces run through one another, vertices around them go back part of their way from `before`: in each knot of such faces as far as leaves the
// fewest that cross or are inverted. `filter`: none for all of them.
struct TakenBack {
  bool any = false;      // faces crossed; else nothing is changed
  std::size_t left = 0;  // what still does, and what is inverted, by how bad it is
};
TakenBack take_back_crossings(QuadMesh& mesh, const std::vector<Vec3>& before, const CrossingFilter& filter, const Progress& progress);

}  // namespace hybrid_mesh
