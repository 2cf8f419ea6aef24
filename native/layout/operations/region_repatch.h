// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "layout/drawn/drawn_layout.h"
#include "layout/level_state.h"
#include "parameterization/global_map.h"

namespace hybrid_mesh {

// How the new quads of a region are found.
struct RegionPattern {
  enum class Kind {
    Drawn,      // cut along curves
    Automatic,  // see automatic_edit()
    Cubes,      // a cube tower on a disk
    Rows,       // of an annulus: see rows_edit()
    Even,       // of even size, whatever the topology: see even_edit()
    Template    // given
  };
  Kind kind = Kind::Drawn;
  std::vector<DrawnStroke> strokes;       // Drawn
  int height = 0;                         // Cubes, Rows; 0: so that quads are about square, at least 1
  int even_quads = 0;                     // Even: about so many; 0: as many as the region has
  std::vector<std::array<int, 4>> quads;  // Template: numbered as in LayoutEdit
  LayoutOutline outline;                  // Even: the quads that it became where it was found, so numbered, and where they lay, if that is known
};
// Moves all that has a place in space.
void move_pattern(RegionPattern& pattern, const PointMove& move);

// Quads of one level that are to be laid out anew: a region of any topology.
struct RegionRepatch {
  std::vector<int> patches;
  std::vector<PatchSide> starts;  // the sides that begin at the first corners of the first rims, see make_region()
  RegionPattern pattern;          // where the level's maps have the surface
  std::vector<int> opens;  // events of the level's surface that open: they are inside the region, and the pattern is laid out on what comes then
  int buffer_rings = 1;    // so many rings of quads around are relaxed with the new ones; 0: none
  // How much is done for a smooth map. There are few quads, close to each other: they get a finer coarse mesh than a whole base.
  GlobalMapOptions map{.vertices_a_quad = 30};
};

// Lays out a region anew: its part of the surface, cut out along its sides, is cut along those of the new quads, these are mapped, and the map is
// relaxed there and in the rings around, at their cost alone. What lies farther off keeps its map exactly. Throws LayoutError for curves that make no
// quads of the region, Error{InvalidInput} if the quads are no region, the pattern does not fit it, or an event is open
// already, NoMap if no map is found.
MappedEdit repatch_region(const LevelState& state, const RegionRepatch& region, const Progress& progress);

}  // namespace hybrid_mesh
