// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "base/error.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// The readers of single formats. They report what is wrong with the bytes; read_polygon_soup() checks indices, finiteness and that there
// are faces, so that these rules are the same for all. Memory stays proportional to the bytes.
PolygonSoup read_ply(std::string_view bytes, const std::string& name);
PolygonSoup read_obj(std::string_view bytes, const std::string& name);
PolygonSoup read_off(std::string_view bytes, const std::string& name);
PolygonSoup read_stl(std::string_view bytes, const std::string& name);

// The longest prefix that is fit to be quoted in a message of one line.
inline std::string quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text.substr(0, 40)) out += c >= 32 && c < 127 ? c : '?';
  return out + (text.size() > 40 ? "...'" : "'");
}

[[noreturn]] inline void refuse_file(const std::string& name, const std::string& cause) {
  throw Error(ErrorCode::CorruptStream, name + ": " + cause);
}

// Collects polygons corner by corner.
class PolygonCollector {
 public:
  explicit PolygonCollector(PolygonSoup& soup) : soup_(soup) {}

  void add_corner(std::int32_t index) { soup_.indices.push_back(index); }
  void end_polygon() {
    if (soup_.indices.size() - static_cast<std::size_t>(soup_.offsets.back()) < 3)
      soup_.indices.resize(static_cast<std::size_t>(soup_.offsets.back()));
    else
      soup_.offsets.push_back(static_cast<std::int64_t>(soup_.indices.size()));
  }

 private:
  PolygonSoup& soup_;
};

// An index as the soup stores it; whatever does not fit becomes one that is out of range for sure.
inline std::int32_t to_index(std::int64_t index) {
  return index < 0 || index >= std::numeric_limits<std::int32_t>::max() ? -1 : static_cast<std::int32_t>(index);
}

}  // namespace hybrid_mesh
