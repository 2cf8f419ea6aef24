// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "remesh/source.h"

namespace hybrid_mesh {

// Levels and base size of a mesh with a vertex budget.
// Of what is remeshed: of a half half of the mesh's.
struct Budget {
  std::int64_t vertices = 0;
  int levels = 0;
  double base_size = 0;  // see BaseDomainOptions
  double boundary_side = 0;
  double shrink = 1;  // of the quads that a minimal base gets on its level with operations: what opens above it adds to them
};

// What a candidate is planned for.
struct Target {
  std::int64_t vertices = 0;  // of the whole mesh; 0: what the options say, or as many as the source has
  int levels_less = 0;        // than usual above the base, which has four times as many quads for each
  bool features = true;       // does the base keep the source's, if there are any?
};

// Vertices of a uniform mesh some levels above one of so many quads, of that Euler number and with so many sides on the boundary.
std::int64_t uniform_vertices(std::int64_t quads, std::int64_t euler, std::int64_t boundary_sides, int levels);

Budget plan_budget(const RemeshOptions& options, const Source& source, const Target& target);
// The same with another number of levels.
Budget with_levels(Budget budget, int levels, const RemeshOptions& options, const Source& source);

// The most levels above one of so many quads, whose level is given, of which a uniform mesh has at most so many vertices; at least that level.
int levels_within(std::int64_t vertices, int level, std::int64_t quads, std::int64_t euler, std::int64_t boundary_sides);

}  // namespace hybrid_mesh
