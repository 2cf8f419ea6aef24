// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/fingerprint.h"

#include <cstdint>
#include <cstdio>
#include <cstring>

namespace hybrid_mesh {

// FNV-1a.
std::string fingerprint(const TriangleSurface& surface, const std::vector<double>& values) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&](std::uint64_t word) {
    for (int i = 0; i < 8; ++i) {
      hash ^= (word >> (8 * i)) & 255;
      hash *= 1099511628211ull;
    }
  };
  const auto add_number = [&](double number) {
    std::uint64_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    add(bits);
  };
  for (const Vec3& p : surface.points)
    for (int i = 0; i < 3; ++i) add_number(p[i]);
  for (const auto& f : surface.faces)
    for (const int v : f) add(static_cast<std::uint64_t>(v));
  for (const double value : values) add_number(value);
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace hybrid_mesh
