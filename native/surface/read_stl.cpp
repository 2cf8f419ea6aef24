// SPDX-License-Identifier: GPL-3.0-or-later
#include <bit>
#include <cstring>

#include "surface/coincident_points.h"
#include "surface/mesh_formats.h"
#include "surface/soup_builder.h"
#include "surface/text_encoding.h"
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
bool has_size_of_binary(std::string_view bytes) {
  return bytes.size() >= header_size && bytes.size() == header_size + facet_size * std::uint64_t{little_endian(bytes.data() + 80)};
}
bool is_text(std::string_view text) {
  for (const char c : text.substr(0, 1000))
    if (c >= 0 && c < ' ' && (c == '\0' || !is_padding({&c, 1}))) return false;
  TextScanner scanner(text);
  return equals(scanner.token(), "solid");
}

PolygonSoup read_text(std::string_view text, const std::string& name) {
  TextScanner scanner(text);
  SoupBuilder soup(name, [&] { return FilePlace{"line", scanner.line()}; });
  bool in_solid = false, in_facet = false;
  for (std::string_view token = scanner.token(); !is_padding(token); token = scanner.token()) {
    if (equals(token, "vertex")) {
      if (!in_facet) soup.refuse("a vertex outside a facet");
      Vec3 point;
      for (int i = 0; i < 3; ++i) {
        const std::string_view number = scanner.token_in_line();
        if (number.empty()) soup.refuse("a vertex needs three coordinates");
        if (!parse_number(number, point[i])) soup.refuse(quoted(number) + " is not a number");
      }
      soup.add_point(point);
      soup.add_corner(static_cast<std::int64_t>(soup.point_count()) - 1);
    } else if (equals(token, "facet")) {
      if (!in_solid || in_facet) soup.refuse("a facet where none can be");
      in_facet = true;
      scanner.next_line();  // the normal follows from the corners
    } else if (equals(token, "endfacet")) {
      if (!in_facet) soup.refuse("the end of a facet that has not begun");
      in_facet = false;
      soup.end_polygon();
    } else if (equals(token, "solid")) {
      in_solid = true;
      scanner.next_line();  // a name, of any words
    } else if (equals(token, "endsolid")) {
      if (in_facet) soup.refuse("a facet does not end");
      in_solid = false;
      scanner.next_line();
    } else if (equals(token, "outer") || equals(token, "loop") || equals(token, "endloop")) {
      continue;
    } else {
      soup.refuse(quoted(token) + " is no word of an STL file");
    }
  }
  if (in_solid) soup.refuse("truncated: the solid does not end");
  return soup.finish();
}

PolygonSoup read_binary(std::string_view bytes, const std::string& name) {
  if (bytes.size() < header_size) refuse_file(name, "truncated: too short for an STL file");
  const std::uint64_t count = little_endian(bytes.data() + 80), held = (bytes.size() - header_size) / facet_size;
  // Less than a facet may follow, or zeros that fill a block; more is surface that would be lost.
  if (held < count || (held > count && !is_padding(bytes.substr(header_size + count * facet_size))))
    refuse_file(name, (held < count ? "truncated: " : "damaged: ") + std::string("its header promises ") + std::to_string(count) +
                          " facets, and there is room for " + std::to_string(held));
  std::size_t at = header_size;
  SoupBuilder soup(name, [&] { return FilePlace{"byte", at}; });
  soup.reserve_points(3 * count);
  soup.reserve_polygons(count);
  for (std::uint64_t f = 0; f < count; ++f) {
    at = header_size + f * facet_size + 12;
    for (int corner = 0; corner < 3; ++corner, at += 12) {
      Vec3 point;
      for (int i = 0; i < 3; ++i) point[i] = std::bit_cast<float>(little_endian(bytes.data() + at + 4 * i));
      soup.add_point(point);
      soup.add_corner(static_cast<std::int64_t>(soup.point_count()) - 1);
    }
    soup.end_polygon();
  }
  return soup.finish();
}

// STL repeats a point for every facet that has it.
void join_facets(PolygonSoup& soup) {
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
  const DecodedText text(has_size_of_binary(bytes) ? std::string_view() : bytes);
  PolygonSoup soup = is_text(text.view()) ? read_text(text.view(), name) : read_binary(bytes, name);
  join_facets(soup);
  return soup;
}

}  // namespace hybrid_mesh
