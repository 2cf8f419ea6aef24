// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_formats.h"
#include "surface/text_scanner.h"

namespace hybrid_mesh {

namespace {

// [ST][C][N]OFF; what its letters announce stands after the coordinates of a point and is skipped.
bool is_header_keyword(std::string_view token) {
  if (token.substr(0, 2) == "ST") token.remove_prefix(2);
  if (token.substr(0, 1) == "C") token.remove_prefix(1);
  if (token.substr(0, 1) == "N") token.remove_prefix(1);
  return token == "OFF";
}

}  // namespace

PolygonSoup read_off(std::string_view bytes, const std::string& name) {
  if (bytes.substr(0, 3) == "\xef\xbb\xbf") bytes.remove_prefix(3);
  TextScanner scanner(bytes, '#');
  const auto where = [&] { return "line " + std::to_string(scanner.line()) + ": "; };
  const auto integer = [&](std::string_view token, const char* what) {
    std::int64_t value = 0;
    if (token.empty()) refuse_file(name, std::string("truncated: it ends where ") + what + " should be");
    if (!parse_integer(token, value)) refuse_file(name, where() + quoted(token) + " is not " + what);
    return value;
  };

  std::string_view token = scanner.token();
  if (is_header_keyword(token)) {
    token = scanner.token();
    if (token == "BINARY") throw Error(ErrorCode::Unsupported, name + ": binary OFF files are not supported");
  } else if (token.size() >= 3 && token.substr(token.size() - 3) == "OFF") {
    throw Error(ErrorCode::Unsupported, name + ": OFF files of kind " + quoted(token) + " are not supported");
  } else if (std::int64_t count; !parse_integer(token, count)) {
    refuse_file(name, "not an OFF file");  // the keyword is optional, the counts are not
  }
  const std::int64_t point_count = integer(token, "the number of points");
  const std::int64_t face_count = integer(scanner.token(), "the number of faces");
  scanner.next_line();  // the number of edges is of no use, and some files leave it out
  if (point_count < 0 || face_count < 0) refuse_file(name, "a negative number of points or faces");
  // A point takes six bytes at least ("0 0 0" and a line end), a face two.
  const auto left = static_cast<std::int64_t>(scanner.rest().size()) + 1;
  if (point_count > left / 6 || face_count > left / 2)
    refuse_file(name, "truncated: its header promises " + std::to_string(point_count) + " points and " + std::to_string(face_count) +
                          " faces, more than the file can hold");

  PolygonSoup soup;
  soup.points.resize(static_cast<std::size_t>(point_count));
  for (Vec3& point : soup.points) {
    for (int i = 0; i < 3; ++i) {
      token = scanner.token();
      if (token.empty()) refuse_file(name, "truncated: it ends among the points");
      if (!parse_number(token, point[i])) refuse_file(name, where() + quoted(token) + " is not a number");
    }
    scanner.next_line();
  }
  PolygonCollector polygons(soup);
  for (std::int64_t f = 0; f < face_count; ++f) {
    const std::int64_t corners = integer(scanner.token(), "a number of corners");
    if (corners < 0 || corners > static_cast<std::int64_t>(scanner.rest().size()))
      refuse_file(name, where() + "a face of " + std::to_string(corners) + " corners");
    for (std::int64_t c = 0; c < corners; ++c) polygons.add_corner(to_index(integer(scanner.token(), "a face corner")));
    polygons.end_polygon();
    scanner.next_line();
  }
  return soup;
}

}  // namespace hybrid_mesh
