// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/level_state.h"
#include "parameterization/global_map.h"
#include "parameterization/patch_gluing.h"

namespace hybrid_mesh {

// Of lengths in unit size, with which the quads have area 1 on average.
double unit_quad_scale(const LevelState& state, const QuadGraph& quads);

struct RelaxedMaps {
  std::vector<PatchMap> maps;  // one a patch
  double energy = 0;           // beyond an isometry's, in quads
};
// Smooths the maps of some patches of a part of a level, in unit size, together. `numbers`: of these patches in the level, whose quads are `level`:
// sides where it goes on with others are held, so that the maps around still fit; other irregular nodes on the boundary go along it to where it
// turns. `scale`: see unit_quad_scale(). `glued`: what the part was made from, and has the sources of its points and faces. Points that cutting has
// put in go where they can, or maps would get more of them each time that they are relaxed. Throws NoMap.
RelaxedMaps relaxed_maps(const MappedSurface& part, const std::vector<int>& patches, const QuadGraph& level, const std::vector<int>& numbers,
                         double scale, const GluedMaps& glued, GlobalMapOptions options, const Progress& progress);

}  // namespace hybrid_mesh
