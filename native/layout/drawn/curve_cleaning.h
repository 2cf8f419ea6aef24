// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/context.h"
#include "layout/curves/surface_curves.h"

namespace hybrid_mesh {

struct CleaningOptions {
  double snap = 0.02;               // what is smaller is not meant
  std::vector<int> boundary_nodes;  // vertices that stay nodes where they are
  std::vector<int> junctions;       // vertices where strokes were meant to meet
};

// Takes out of drawn curves, made from `surface`, what is too small to be meant: overshoots, short pieces between nodes that are drawn as one, small
// loops, and slips of strokes that cross on their way to a common node. Two pieces of a stroke that meet alone become one.
void clean_curves(const TriangleSurface& surface, SurfaceCurves& curves, const CleaningOptions& options, const Progress& progress);

}  // namespace hybrid_mesh
