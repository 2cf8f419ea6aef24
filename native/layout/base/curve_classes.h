// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/base/mesh_features.h"

namespace hybrid_mesh {

// Which feature curves are to have the same number of edges: opposite sides of a piece of surface with four corners, and the two rims of a tube. And
// how a vertex less on each curve of such a class changes the pieces at its ends, whose triangles can be paired only where they are even in number.
struct CurveClasses {
  struct Piece {
    bool odd = false;
    std::vector<int> classes;  // of which an odd number of curves are on its rim
  };
  std::vector<std::vector<int>> curves;  // per class
  std::vector<int> edges;                // per curve: how many it has
  std::vector<double> length;            // per curve
  std::vector<Piece> pieces;

  // Changes how many edges each curve of a class is to have by one, so that no piece stays odd that can be helped: up where the class has more, or
  // else down. A curve on the boundary changes one piece alone.
  void make_even(std::vector<int>& wanted) const;

 private:
  std::vector<int> way_to_even(const std::vector<char>& odd, const std::vector<char>& usable) const;
};

// `features`: the boundary, if there is one, among them. `fineness`: see DecimationOptions.
CurveClasses curve_classes(const EditMesh& mesh, const std::vector<Vec3>& points, const MeshFeatures& features, const std::vector<double>& fineness);

}  // namespace hybrid_mesh
