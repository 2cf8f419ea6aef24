// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "base/found.h"
#include "layout/operations/region_repatch.h"

namespace hybrid_mesh {

// Per event of a level's surface that is closed, the quads whose maps have its caps or its tube: of a cut on either side, else all first.
using CoveringQuads = std::vector<std::array<std::vector<int>, 2>>;

// Finds them. It remembers what the parts of maps cover, and shares these maps: asked again after an operation, it looks at the new quads alone.
class CoveringSearch {
 public:
  CoveringQuads quads_of(const LevelState& state);

 private:
  using Covered = std::vector<std::pair<int, int>>;  // events, and which of their caps
  struct KnownMap {
    bool covers_any = false;
    std::map<std::array<double, 2>, std::map<double, Covered>> parts;  // by corner and width of the square
  };
  std::map<std::shared_ptr<const PatchMap>, KnownMap> known_;
};

// The region of a level in which an event opens, and its layout: for a cut, two disks over its caps, grown until their rims have equally many sides,
// and rows between them; for a boundary, rows from the rim to it; for a tube, the ring that covers it, and two disks. Nothing, and why, where there
// is no room on this level.
struct OpeningRoom {
  int margin = 0;         // rings of quads by which the region is wider at least: a rim through a corner of a cap leaves no room for what opens
  bool together = false;  // the two sides of a cut in one disk, which gets a handle: for sides that have no room beside each other
};
Found<RegionRepatch> find_opening(const LevelState& state, const CoveringQuads& covering, int event, const OpeningRoom& room);

}  // namespace hybrid_mesh
