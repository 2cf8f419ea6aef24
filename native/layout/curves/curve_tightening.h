// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "layout/curves/face_strip.h"
#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {

// Shortens curves on a surface to geodesics, their ends held, within the room that other curves and vertices with curve ends leave them: no curve
// ever passes over another.
class CurveTightener {
 public:
  // `fixed`: per curve, those that stay as they are; others are led around where these cross an edge.
  CurveTightener(SurfaceCurves& curves, std::vector<char> fixed) : curves_(curves), fixed_(std::move(fixed)) {}

  // False if the curve could be shortened to nothing, or to another one: then it is removed.
  bool tighten(int c);
  // All that are not fixed, until none can be shortened further. Throws NoMap if one vanishes.
  void tighten_all(const Progress& progress);

 private:
  FaceStrip strip_of(int c);
  void place(const FaceStrip& strip);
  bool pass_vertices(int c, const FaceStrip& strip);
  double angle_around(int v);

  SurfaceCurves& curves_;
  std::vector<char> fixed_;
  std::vector<int> crossings_, half_edges_;  // of the curve at hand
  std::vector<double> angle_around_;         // per vertex, -1: not known yet
  bool changed_ = false;
};

}  // namespace hybrid_mesh
