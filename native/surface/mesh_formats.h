// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "base/error.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// The readers of single formats. They report what is wrong with the bytes, and where; what holds for every format SoupBuilder checks. Memory stays
// proportional to the bytes.
// `density`: see read_polygon_soup().
PolygonSoup read_ply(std::string_view bytes, const std::string& name, std::string_view density);
PolygonSoup read_obj(std::string_view bytes, const std::string& name);
PolygonSoup read_off(std::string_view bytes, const std::string& name);
PolygonSoup read_stl(std::string_view bytes, const std::string& name);

// The longest prefix that is fit to be quoted in a message of one line.
inline std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 40)) out += c >= 32 && c < 127 ? c : '?';
  return out + (text.size() > 40 ? "...'" : "'");
}

// For what is wrong with a file as a whole.
[[noreturn]] inline void refuse_file(const std::string& name, const std::string& cause) {
  throw Error(ErrorCode::CorruptStream, name + ": " + cause);
}

}  // namespace hybrid_mesh
