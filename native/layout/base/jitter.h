// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace hybrid_mesh {

// A number in [0, 1) that depends on the seed and the vertex alone.
inline double jitter(std::uint64_t seed, int v) {
  std::uint64_t x = seed * 0x9E3779B97F4A7C15ull + static_cast<std::uint64_t>(v) * 0xBF58476D1CE4E5B9ull;
  x ^= x >> 31, x *= 0x94D049BB133111EBull, x ^= x >> 29;
  return static_cast<double>(x >> 11) * 0x1.0p-53;
}

}  // namespace hybrid_mesh
