// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdio>
#include <string>

namespace hybrid_mesh {

// How messages write figures; `format` as of printf, of one double.
inline std::string formatted(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// As they write errors: 1.23e-04.
inline std::string scientific(double value) { return formatted("%.2e", value); }

}  // namespace hybrid_mesh
