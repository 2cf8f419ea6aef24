// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "layout/base_map.h"
#include "layout/drawn_layout.h"

namespace hybrid_mesh {

// Quads of one level and the curves along which they are to be laid out anew.
struct DrawnRegion {
  std::vector<int> patches;
  std::vector<DrawnStroke> strokes;  // on a surface of unit size, as the level's map is
  int buffer_rings = 1;              // so many rings of quads around are relaxed with the new ones; 0: none
};

// Lays out a region anew: its part of the surface, cut out along its sides, is cut along the curves, the faces are mapped, and the map is relaxed there and in the rings around.
// What lies farther off keeps its map exactly. `map`: that of the region's level over `surface`; it is changed, and so is `map.changed`. Returns the edit.
// Throws LayoutError for curves that make no quads of the region, Error{InvalidInput} if the quads are no disk, Error{Internal} if no map is found: then `map` is as it was.
LayoutEdit repatch_region(const TriangleSurface& surface, LevelMap& map, const DrawnRegion& region, const Progress& progress);

}  // namespace hybrid_mesh
