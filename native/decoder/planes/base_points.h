// SPDX-License-Identifier: GPL-3.0-or-later
// Private to decoder/ and codec/.
#pragma once

#include <cstdint>
#include <vector>

#include "decoder/bits/bit_models.h"
#include "decoder/forest/level_mesh.h"

namespace hybrid_mesh {

// Added to the base's coordinates, so that zero, where everything is that a stream says nothing of, is well inside a step, however large that is.
inline constexpr double base_shift = 1.0 / 3;

// Positions of the base as far as they are known: whole numbers of steps 2^-bits, rounded down, of three coordinates a vertex.
struct BasePoints {
  int bits = 0;
  std::vector<std::int32_t> steps;
  std::size_t coded = 0;  // in order: how many have their last bit

  // In the middle of what is possible.
  double value(std::size_t i) const;
};

// Each predicted from those before. `all`: writers' points, with more bits.
void code_base_points(BitCoder& coder, const LevelMesh& mesh, BasePoints& known, int bits, const BasePoints* all);
// A bit more of each.
void refine_base_points(BitCoder& coder, BasePoints& known, const BasePoints* all);

}  // namespace hybrid_mesh
