// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "layout/search/layout_script.h"
#include "layout/search/trial_map.h"

namespace hybrid_mesh {

// How the map of one level is made.
struct LevelVersion {
  double vertices = 0;  // of the version of the surface that is worked on
  GlobalMapOptions map;
};

struct MappedLayouts {
  LayoutScript script;  // what was done
  // The map of the base domain, and that of the quads of each finer level that was edited; carried to the surface if there are finer levels.
  struct Stage {
    int level;
    CarriedMap map;
    std::string failure;  // why the map cannot be carried to the surface; empty as far as is known
  };
  std::vector<Stage> stages;
};

// Works on the layout of a level, whose number is given, and on its map; returns the edits that it has kept.
using LevelWork = std::function<std::vector<LayoutScript::Edit>(TrialMap& map, std::size_t level, const Progress& progress)>;

// Maps a base and works on it, then on its quadrants, and so on, a level for each of `versions`. The maps of levels that have edits are carried to
// the surface meanwhile. Throws NoMap where a map cannot be found, or that of a finer level not be carried to the surface.
MappedLayouts map_levels(CarriedMap base, const std::vector<LevelVersion>& versions, const LevelWork& work, const Progress& progress);

}  // namespace hybrid_mesh
