// SPDX-License-Identifier: GPL-3.0-or-later
// Private to decoder/ and codec/.
#pragma once

#include <cstddef>

#include "decoder/transform/level_step.h"

namespace hybrid_mesh {

// What one component of a detail counts: by how much it moves the finest level's vertices, in the root of the sum of squares, as on a regular grid.
// Of a side (kind 0), a centre (1) or another vertex (2), `levels` below the finest.
double coefficient_weight(int kind, int levels);

// The same, with components along the surface (1, 2) made smaller: they matter less to its shape.
double coefficient_scale(int kind, std::size_t component, int levels);

int coefficient_kind(DetailKind kind);

}  // namespace hybrid_mesh
