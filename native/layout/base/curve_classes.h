// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/base/mesh_features.h"

namespace hybrid_mesh {

// Which feature curves are to have the same number of edges: opposite sides of a piece of surface with four corners, and the two rims of a tube. And
// which of them are around a piece, whose triangles can be paired only where they are even in number: as its rim has an even number of edges.
struct CurveClasses {
  std::vector<std::vector<int>> curves;  // per class
  std::vector<int> edges;                // per curve: how many it has
  std::vector<double> length;            // per curve
  std::vector<std::vector<int>> rims;    // per piece: the curves around it, each as often as the piece lies beside it

  // Changes how many edges curves are to have, those of a class together where that is enough, so that no rim is odd that can be helped: up where
  // they have more, or else down, but not below their `least`. A curve on the boundary changes one piece alone.
  void make_even(std::vector<int>& wanted, const std::vector<int>& least) const;
};

// `features`: the boundary, if there is one, among them. `fineness`: see DecimationOptions.
CurveClasses curve_classes(const EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, const std::vector<double>& fineness);

}  // namespace hybrid_mesh
