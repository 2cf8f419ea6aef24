// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <cstring>

#include "surface/coincident_points.h"
#include "surface/mesh_formats.h"
#include "surface/text_scanner.h"

namespace hybrid_mesh {

namespace {

constexpr std::size_t header_size = 84, facet_size = 50;

std::uint32_t little_endian(const char* bytes) {
  const auto byte = [&](int i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i])); };
  return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
}

bool equals(std::string_view token, std::string_view lower_case) {
  if (token.size() != lower_case.size()) return false;
  for (std::size_t i = 0; i < token.size(); ++i)
    if ((token[i] >= 'A' && token[i] <= 'Z' ? token[i] + 32 : token[i]) != lower_case[i]) return false;
  return true;
}

// Binary files may begin with "solid" too: their size decides, then whether there are control characters, which every facet count has.
bool is_text(std::string_view bytes) {
  if (bytes.size() >= header_size && bytes.size() == header_size + facet_size * std::uint64_t{little_endian(bytes.data() + 80)}) return false;
  for (const char c : bytes.substr(0, 1000))
    if (c >= 0 && c < ' ' && !is_blank(c) && !is_line_end(c)) return false;
  TextScanner scanner(bytes);
  return equals(scanner.token(), "solid");
}

PolygonSoup read_text(std::string_view bytes, const std::string& name) {
  PolygonSoup soup;
  PolygonCollector polygons(soup);
  TextScanner scanner(bytes);
  bool in_solid = false, in_facet = false;
  for (std::string_view token = scanner.token(); !token.empty(); token = scanner.token()) {
    const auto refuse = [&](const std::string& cause) { refuse_file(name, "line " + std::to_string(scanner.line()) + ": " + cause); };
    if (equals(token, "vertex")) {
      if (!in_facet) refuse("a vertex outside a facet");
      Vec3 point;
      for (int i = 0; i < 3; ++i) {
        const std::string_view number = scanner.token_in_line();
        if (number.empty()) refuse("a vertex needs three coordinates");
        if (!parse_number(number, point[i])) refuse(quoted(number) + " is not a number");
      }
      polygons.add_corner(to_index(static_cast<std::int64_t>(soup.points.size())));
      soup.points.push_back(point);
    } else if (equals(token, "facet")) {
      if (!in_solid || in_facet) refuse("a facet where none can be");
      in_facet = true;
      scanner.next_line();  // the normal follows from the corners
    } else if (equals(token, "endfacet")) {
      if (!in_facet) refuse("the end of a facet that has not begun");
      in_facet = false;
      polygons.end_polygon();
    } else if (equals(token, "solid")) {
      in_solid = true;
      scanner.next_line();  // a name, of any words
    } else if (equals(token, "endsolid")) {
      if (in_facet) refuse("a facet does not end");
      in_solid = false;
      scanner.next_line();
    } else if (equals(token, "outer") || equals(token, "loop") || equals(token, "endloop")) {
      continue;
    } else {
      refuse(quoted(token) + " is no word of an STL file");
    }
  }
  if (in_solid) refuse_file(name, "truncated: the solid does not end");
  return soup;
}

PolygonSoup read_binary(std::string_view bytes, const std::string& name) {
  if (bytes.size() < header_size) refuse_file(name, "truncated: too short for an STL file");
  const std::uint64_t count = little_endian(bytes.data() + 80);
  if ((bytes.size() - header_size) / facet_size < count)
    refuse_file(name, "truncated: its header promises " + std::to_string(count) + " facets, more than the file holds");
  PolygonSoup soup;
  soup.points.reserve(3 * count);
  PolygonCollector polygons(soup);
  for (std::uint64_t f = 0; f < count; ++f) {
    const char* at = bytes.data() + header_size + f * facet_size + 12;
    for (int corner = 0; corner < 3; ++corner, at += 12) {
      Vec3 point;
      for (int i = 0; i < 3; ++i) point[i] = std::bit_cast<float>(little_endian(at + 4 * i));
      polygons.add_corner(to_index(static_cast<std::int64_t>(soup.points.size())));
      soup.points.push_back(point);
    }
    polygons.end_polygon();
  }
  return soup;
}

// STL repeats a point for every facet that has it.
void join_facets(PolygonSoup& soup) {
  // What is refused later is left as it is; points that are not numbers equal no point.
  if (soup.points.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) return;
  for (const Vec3& point : soup.points)
    if (!point.allFinite()) return;
  const std::vector<std::int32_t> first = first_coincident(soup.points);
  std::vector<std::int32_t> renamed(soup.points.size());
  std::int32_t kept = 0;
  for (std::size_t i = 0; i < soup.points.size(); ++i) {
    const bool is_first = first[i] == static_cast<std::int32_t>(i);
    renamed[i] = is_first ? kept : renamed[first[i]];
    if (is_first) soup.points[kept++] = soup.points[i];
  }
  soup.points.resize(kept);
  for (std::int32_t& index : soup.indices) index = renamed[index];
}

}  // namespace

PolygonSoup read_stl(std::string_view bytes, const std::string& name) {
  PolygonSoup soup = is_text(bytes) ? read_text(bytes, name) : read_binary(bytes, name);
  join_facets(soup);
  return soup;
}

}  // namespace hybrid_mesh
