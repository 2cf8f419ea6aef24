// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/coincident_points.h"

#include <bit>

namespace hybrid_mesh {

namespace {

std::uint64_t hash_of(const Vec3& p) {
  std::uint64_t h = 0x9e3779b97f4a7c15ull;
  for (int i = 0; i < 3; ++i) {
    const double x = p[i] + 0.0;  // -0 becomes 0
    h ^= std::bit_cast<std::uint64_t>(x);
    h *= 0xbf58476d1ce4e5b9ull;
    h ^= h >> 29;
  }
  h *= 0x94d049bb133111ebull;
  return h ^ (h >> 32);
}

}  // namespace

std::vector<std::int32_t> first_coincident(const std::vector<Vec3>& points) {
  std::vector<std::int32_t> first(points.size());
  std::vector<std::int32_t> slots(std::bit_ceil(2 * points.size() + 1), -1);
  const std::size_t mask = slots.size() - 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t slot = hash_of(points[i]) & mask;
    while (slots[slot] >= 0 && points[slots[slot]] != points[i]) slot = (slot + 1) & mask;
    if (slots[slot] < 0) slots[slot] = static_cast<std::int32_t>(i);
    first[i] = slots[slot];
  }
  return first;
}

}  // namespace hybrid_mesh
