// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_formats.h"
#include "surface/soup_builder.h"
#include "surface/text_encoding.h"
#include "surface/text_scanner.h"

namespace hybrid_mesh {

namespace {

bool take(std::string_view& text, std::string_view prefix) {
  if (text.substr(0, prefix.size()) != prefix) return false;
  text.remove_prefix(prefix.size());
  return true;
}

// [ST][C][N][4][n]OFF, the letters in any order. What ST, C and N announce stands after the coordinates of a point and is skipped.
struct Keyword {
  bool found = false;
  bool four_coordinates = false;
  bool any_coordinates = false;
  std::string_view rest;  // the number of points, where no blank comes before it

  explicit Keyword(std::string_view token) {
    while (!found) {
      if (take(token, "OFF") || take(token, "off"))
        found = true;
      else if (take(token, "4"))
        four_coordinates = true;
      else if (take(token, "n"))
        any_coordinates = true;
      else if (!take(token, "ST") && !take(token, "C") && !take(token, "N"))
        return;
    }
    rest = token;
  }
};

}  // namespace

PolygonSoup read_off(std::string_view bytes, const std::string& name) {
  const DecodedText text(bytes);
  TextScanner scanner(text.view(), '#');
  SoupBuilder soup(name, [&] { return FilePlace{"line", scanner.line()}; });
  const auto integer = [&](std::string_view token, const char* what) {
    std::int64_t value = 0;
    if (token.empty()) soup.refuse(std::string("truncated: the file ends where ") + what + " should be");
    if (!parse_integer(token, value)) soup.refuse(quoted(token) + " is not " + what);
    return value;
  };

  std::string_view token = scanner.token();
  if (const Keyword keyword(token); keyword.found) {
    const auto unsupported = [&](const char* what) { throw Error(ErrorCode::Unsupported, name + ": OFF files " + what + " are not supported"); };
    if (keyword.four_coordinates) unsupported("of points with four coordinates (4OFF)");
    if (keyword.any_coordinates) unsupported("of points with any number of coordinates (nOFF)");
    token = keyword.rest.empty() ? scanner.token() : keyword.rest;
    if (token == "BINARY") unsupported("that are binary");
  } else if (std::int64_t count; !parse_integer(token, count)) {
    refuse_file(name, "not an OFF file");  // the keyword is optional, the counts are not
  }
  const std::int64_t point_count = integer(token, "the number of points");
  const std::int64_t face_count = integer(scanner.token(), "the number of faces");
  if (point_count < 0 || face_count < 0) soup.refuse("a negative number of points or faces");
  scanner.next_line();  // the number of edges is of no use, and some files leave it out
  // A point takes six bytes at least ("0 0 0" and a line end), a face two.
  const auto left = static_cast<std::int64_t>(scanner.rest().size()) + 1;
  if (point_count > left / 6 || face_count > left / 2)
    refuse_file(name, "truncated: its header promises " + std::to_string(point_count) + " points and " + std::to_string(face_count) +
                          " faces, more than the file can hold");

  soup.reserve_points(static_cast<std::uint64_t>(point_count));
  for (std::int64_t p = 0; p < point_count; ++p) {
    Vec3 point;
    for (int i = 0; i < 3; ++i) {
      token = scanner.token();
      if (token.empty()) soup.refuse("truncated: the file ends at point " + std::to_string(p + 1) + " of " + std::to_string(point_count));
      if (!parse_number(token, point[i])) soup.refuse(quoted(token) + " is not a number");
    }
    soup.add_point(point);
    scanner.next_line();
  }
  for (std::int64_t f = 0; f < face_count; ++f) {
    const std::int64_t corners = integer(scanner.token(), "a number of corners");
    if (corners < 0 || corners > static_cast<std::int64_t>(scanner.rest().size())) soup.refuse("a face of " + std::to_string(corners) + " corners");
    for (std::int64_t c = 0; c < corners; ++c) soup.add_corner(integer(scanner.token(), "a face corner"));
    soup.end_polygon();
    scanner.next_line();
  }
  // With a count that is too small points would be taken for faces, or faces be lost.
  if (token = scanner.token(); !is_padding(token))
    soup.refuse("the file goes on after the " + std::to_string(point_count) + " points and " + std::to_string(face_count) +
                " faces that its header promises");
  return soup.finish();
}

}  // namespace hybrid_mesh
