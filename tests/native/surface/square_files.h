// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "base/error.h"
#include "surface/polygon_soup.h"

// One square of two triangles in every format, and what is asked about reading it.
namespace hybrid_mesh {

template <class T>
std::string raw(T value, bool big) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

inline std::string without_carriage(std::string text) {
  std::erase(text, '\r');
  return text;
}
inline std::string with_carriage(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? "\r\n" : std::string(1, c);
  return out;
}

inline const std::string ply_vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
inline const std::string ply_faces = "element face 2\nproperty list uchar int vertex_indices\n";
inline const std::string ascii_ply =
    "ply\nformat ascii 1.0\n" + ply_vertices + ply_faces + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
inline const std::string obj = "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
inline const std::string off = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

inline std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c + "\n endloop\nendfacet\n";
}
inline const std::string ascii_stl = "solid a square\n" + facet("0 0 0", "1 0 0", "1 1 0") + facet("0 0 0", "1 1 0", "0 1 0") + "endsolid a square\n";

inline std::string binary_stl() {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // as some programs write it
  bytes += raw<std::uint32_t>(2, false);
  for (const auto& t : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
    for (int i = 0; i < 3; ++i) bytes += raw(0.0f, false);
    for (const int v : t)
      for (const float c : {v == 1 || v == 2 ? 1.0f : 0.0f, v >= 2 ? 1.0f : 0.0f, 0.0f}) bytes += raw(c, false);
    bytes += raw<std::uint16_t>(0, false);
  }
  return bytes;
}

inline std::string binary_ply(bool big) {
  std::string bytes = "ply\nformat binary_" + std::string(big ? "big" : "little") + "_endian 1.0\n" + ply_vertices + ply_faces + "end_header\n";
  for (const auto& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)})
    for (int i = 0; i < 3; ++i) bytes += raw(static_cast<float>(p[i]), big);
  for (const auto& t : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
    bytes += raw<std::uint8_t>(3, big);
    for (const int v : t) bytes += raw<std::int32_t>(v, big);
  }
  return bytes;
}

inline void expect_square(const PolygonSoup& soup) {
  EXPECT_EQ(soup.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(soup.indices, (std::vector<std::int32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(soup.offsets, (std::vector<std::int64_t>{0, 3, 6}));
}

inline PolygonSoup read(const std::string& bytes, MeshFormat format) { return read_polygon_soup(bytes, format, "square"); }

// The message of the error that reading ends with; empty if it succeeds.
inline std::string message(const std::string& bytes, MeshFormat format) {
  try {
    read(bytes, format);
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.substr(0, 8), "square: ") << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_LT(what.size(), 200u) << what;
    EXPECT_TRUE(error.code() == ErrorCode::InvalidInput || error.code() == ErrorCode::CorruptStream || error.code() == ErrorCode::Unsupported);
    return what;
  }
  return {};
}

inline bool says(const std::string& bytes, MeshFormat format, const std::string& part) {
  const std::string what = message(bytes, format);
  if (what.find(part) == std::string::npos) ADD_FAILURE() << "'" << what << "' does not say '" << part << "'";
  return true;
}

template <class T>
std::string ply_of_type(const std::string& type, const std::string& count_type, bool big) {
  const std::string format = big ? "binary_big_endian" : "binary_little_endian";
  std::string bytes =
      "ply\nformat " + format + " 1.0\ncomment of many things\nobj_info more\nelement camera 2\nproperty double a\nproperty list uchar short b\n" +
      "element vertex 4\nproperty uchar red\nproperty " + type + " x\nproperty " + type + " y\nproperty list ushort float w\nproperty " + type +
      " z\nelement face 2\nproperty short flags\nproperty list " + count_type + " " + (type[0] == 'f' || type[0] == 'd' ? "int" : type) +
      " vertex_index\nproperty list uchar float texcoord\nelement edge 1\nproperty int vertex1\nend_header\n";
  for (int i = 0; i < 2; ++i) bytes += raw(1.5, big) + raw<std::uint8_t>(2, big) + raw<std::int16_t>(3, big) + raw<std::int16_t>(4, big);
  for (const auto& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)})
    bytes += raw<std::uint8_t>(9, big) + raw(static_cast<T>(p[0]), big) + raw(static_cast<T>(p[1]), big) + raw<std::uint16_t>(1, big) +
             raw(2.5f, big) + raw(static_cast<T>(p[2]), big);
  for (const auto& t : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
    bytes += raw<std::int16_t>(-7, big);
    bytes += count_type == "uchar" ? raw<std::uint8_t>(3, big) : raw<std::uint32_t>(3, big);
    for (const int v : t) bytes += std::is_integral_v<T> ? raw(static_cast<T>(v), big) : raw<std::int32_t>(v, big);
    bytes += raw<std::uint8_t>(1, big) + raw(0.5f, big);
  }
  return bytes + raw<std::int32_t>(5, big);
}

}  // namespace hybrid_mesh
