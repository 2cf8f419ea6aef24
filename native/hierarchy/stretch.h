// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

// How evenly a level's quads sample the surface.
struct LevelStretch {
  std::vector<double> stretch;     // #F: area under the face's node / 4^-level, divided by the area-weighted median; 1 = even
  std::vector<double> anisotropy;  // #F: ratio of the singular values of the map, mean metric over the node; >= 1
};

// Of every face of a mesh taken from the hierarchy (faces made by closure have their node's values). Faces without a map get 1 and 1.
LevelStretch level_stretch(const HybridMesh& hierarchy, const QuadMesh& mesh);

// Area-weighted median: the least x such that half of the weight lies at or below it. 0 if empty.
double weighted_median(const std::vector<double>& values, const std::vector<double>& weights);

}  // namespace hybrid_mesh
