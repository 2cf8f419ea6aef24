// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "base/context.h"
#include "parameterization/corner_motion.h"
#include "parameterization/star_relaxation.h"

namespace hybrid_mesh {

// Merges the points that cutting a surface inserted back into its vertices, in the charts of the cut surface.
class InsertionMerging {
 public:
  InsertionMerging(ChartMesh& charts, const Distortion& density, const PatchedSurface& surface);

  // Merges the inserted points that the map allows to go: no triangle's determinant or 3D shape falls below the bounds.
  void merge(double least_determinant, double least_shape = 1e-6);
  // Merges every inserted point; returns the surface's point for each vertex that is alive, -1 for others. Throws NoMap where the map
  // refuses.
  std::vector<int> merge_all(const Progress& progress);

  // Per vertex whether it is a point of the surface that was cut. Cones keep to these, so that inserted ones can be merged away.
  const std::vector<char>& original() const { return original_; }

 private:
  bool is_inserted(int v) const { return source_[v].vertices[1] >= 0; }
  bool merges_in_place(int h) const;
  double least_determinant_after(int h) const;
  void settle(int cone);
  void settle_corner(int corner);
  void merge_by_force(const Progress& progress);
  bool unfolds_when_merged(int v, int pass);

  ChartMesh& c_;
  Distortion density_;
  StarRelaxation stars_;
  CornerMotion corners_;
  std::vector<PointSource> source_;  // per vertex
  std::vector<char> original_;
};

}  // namespace hybrid_mesh
