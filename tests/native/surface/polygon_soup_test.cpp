// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/polygon_soup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>

#include "base/error.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

namespace fs = std::filesystem;

// A folder of its own for a test, removed after it.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("hybrid_mesh_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

template <class T>
std::string raw(T value, bool big) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  if (big != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

std::string without_carriage(std::string text) {
  std::erase(text, '\r');
  return text;
}
std::string with_carriage(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\n' ? "\r\n" : std::string(1, c);
  return out;
}

const std::string ply_vertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string ply_faces = "element face 2\nproperty list uchar int vertex_indices\n";
const std::string ascii_ply = "ply\nformat ascii 1.0\n" + ply_vertices + ply_faces + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
const std::string obj = "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
const std::string off = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c + "\n endloop\nendfacet\n";
}
const std::string ascii_stl = "solid a square\n" + facet("0 0 0", "1 0 0", "1 1 0") + facet("0 0 0", "1 1 0", "0 1 0") + "endsolid a square\n";

std::string binary_stl() {
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

std::string binary_ply(bool big) {
  std::string bytes = "ply\nformat binary_" + std::string(big ? "big" : "little") + "_endian 1.0\n" + ply_vertices + ply_faces + "end_header\n";
  for (const auto& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)})
    for (int i = 0; i < 3; ++i) bytes += raw(static_cast<float>(p[i]), big);
  for (const auto& t : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
    bytes += raw<std::uint8_t>(3, big);
    for (const int v : t) bytes += raw<std::int32_t>(v, big);
  }
  return bytes;
}

void expect_square(const PolygonSoup& soup) {
  EXPECT_EQ(soup.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(soup.indices, (std::vector<std::int32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(soup.offsets, (std::vector<std::int64_t>{0, 3, 6}));
}

PolygonSoup read(const std::string& bytes, MeshFormat format) { return read_polygon_soup(bytes, format, "square"); }

// The message of the error that reading ends with; empty if it succeeds.
std::string message(const std::string& bytes, MeshFormat format) {
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

bool says(const std::string& bytes, MeshFormat format, const std::string& part) {
  const std::string what = message(bytes, format);
  if (what.find(part) == std::string::npos) ADD_FAILURE() << "'" << what << "' does not say '" << part << "'";
  return true;
}

TEST(PolygonSoup, ReadsTheSameSquareFromEveryFormat) {
  expect_square(read(ascii_ply, MeshFormat::Ply));
  expect_square(read(with_carriage(ascii_ply), MeshFormat::Ply));
  expect_square(read(binary_ply(false), MeshFormat::Ply));
  expect_square(read(binary_ply(true), MeshFormat::Ply));
  expect_square(read(obj, MeshFormat::Obj));
  expect_square(read(with_carriage(obj), MeshFormat::Obj));
  expect_square(read(off, MeshFormat::Off));
  expect_square(read(with_carriage(off), MeshFormat::Off));
  expect_square(read(ascii_stl, MeshFormat::Stl));
  expect_square(read(with_carriage(ascii_stl), MeshFormat::Stl));
  expect_square(read(binary_stl(), MeshFormat::Stl));
  EXPECT_EQ(without_carriage(with_carriage(off)), off);
}

TEST(PolygonSoup, PlyHeadersWithEveryLineEnd) {
  for (const bool big : {false, true})
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      const std::string bytes = binary_ply(big);
      const std::size_t body = bytes.find("end_header\n") + 11;
      std::string header = bytes.substr(0, body), changed;
      for (const char c : header) changed += c == '\n' ? end : std::string(1, c);
      expect_square(read(changed + bytes.substr(body), MeshFormat::Ply));
    }
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

TEST(PolygonSoup, PlyOfEveryTypeAndWithOtherElementsAndProperties) {
  for (const bool big : {false, true})
    for (const std::string count_type : {"uchar", "uint"}) {
      expect_square(read(ply_of_type<std::int8_t>("char", count_type, big), MeshFormat::Ply));
      expect_square(read(ply_of_type<std::uint8_t>("uint8", count_type, big), MeshFormat::Ply));
      expect_square(read(ply_of_type<std::int16_t>("int16", count_type, big), MeshFormat::Ply));
      expect_square(read(ply_of_type<std::uint16_t>("ushort", count_type, big), MeshFormat::Ply));
      expect_square(read(ply_of_type<std::int32_t>("int32", count_type, big), MeshFormat::Ply));
      expect_square(read(ply_of_type<std::uint32_t>("uint", count_type, big), MeshFormat::Ply));
      expect_square(read(ply_of_type<float>("float32", count_type, big), MeshFormat::Ply));
      expect_square(read(ply_of_type<double>("double", count_type, big), MeshFormat::Ply));
    }
}

TEST(PolygonSoup, PlyStripsAndFacesBeforeVertices) {
  const PolygonSoup strips =
      read("ply\nformat ascii 1.0\n" + ply_vertices +
               "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 3 2 1\n",
           MeshFormat::Ply);
  EXPECT_EQ(strips.indices, (std::vector<std::int32_t>{0, 1, 2, 2, 1, 3, 3, 2, 1}));
  expect_square(
      read("ply\nformat ascii 1.0\n" + ply_faces + ply_vertices + "end_header\n3 0 1 2\n3 0 2 3\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n", MeshFormat::Ply));
}

TEST(PolygonSoup, PlyRefusals) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = ascii_ply;
    return text.replace(text.find(from), from.size(), to);
  };
  says("", MeshFormat::Ply, "empty");
  says("plyx\n", MeshFormat::Ply, "not a PLY file");
  says("ply\nformat ascii 1.0\nelement vertex 4\n", MeshFormat::Ply, "header does not end");
  says(with("3 0 2 3", "3 0 2 4"), MeshFormat::Ply, "face 2 has a point index out of range");
  says(with("3 0 2 3", "3 0 2 -1"), MeshFormat::Ply, "out of range");
  says(with("3 0 2 3", "3 0 2 99999999999"), MeshFormat::Ply, "out of range");
  says(with("3 0 2 3", "3 0 x 3"), MeshFormat::Ply, "damaged at 'face' 2");
  says(with("3 0 2 3", "-3 0 2 3"), MeshFormat::Ply, "damaged at 'face' 2");
  says(with("3 0 2 3", "1000000000 0 2 3"), MeshFormat::Ply, "damaged at 'face' 2");
  says(with("1 1 0", "1 nan 0"), MeshFormat::Ply, "point 3 has a coordinate that is not finite");
  says(with("1 1 0", "1 inf 0"), MeshFormat::Ply, "not finite");
  says(with("1 1 0", "1 1e999 0"), MeshFormat::Ply, "not finite");
  says(with("format ascii", "format binary_middle_endian"), MeshFormat::Ply, "unknown format");
  says(with("property float x\n", ""), MeshFormat::Ply, "lacks the properties x, y and z");
  says(with("vertex_indices", "corners"), MeshFormat::Ply, "lacks the properties vertex_indices");
  says(with("property float x", "property quad x"), MeshFormat::Ply, "bad header line");
  says(with("element vertex 4", "element vertex -4"), MeshFormat::Ply, "bad header line");
  says(with("element face 2\n", "element face 0\n"), MeshFormat::Ply, "no faces");
  EXPECT_NE(message(with("3 0 1 2\n3 0 2 3\n", "2 0 1\n1 0\n"), MeshFormat::Ply).find("no faces"), std::string::npos);
  EXPECT_EQ(message(with("1 1 0", "1 1e-999 0"), MeshFormat::Ply), "");
}

TEST(PolygonSoup, RefusesImpossibleCountsAtOnce) {
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"})
    for (const std::string count : {"1000000000000", "9223372036854775807", "4000000000"}) {
      const std::string vertices = "element vertex " + count + "\nproperty float x\nproperty float y\nproperty float z\n";
      says("ply\nformat " + format + " 1.0\n" + vertices + ply_faces + "end_header\n0 0 0\n", MeshFormat::Ply, "promises " + count);
    }
  says("OFF\n1000000000000 2 0\n0 0 0\n", MeshFormat::Off, "promises 1000000000000");
  says("OFF\n1 1000000000000 0\n0 0 0\n", MeshFormat::Off, "promises");
  std::string stl = binary_stl();
  stl.replace(80, 4, "\xff\xff\xff\x7f");
  says(stl, MeshFormat::Stl, "promises 2147483647");
}

TEST(PolygonSoup, ObjForms) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  for (const std::string faces : {"f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n", "f 1//1 2//2 3//3\nf 1//1 3//3 4//4\n", "f 1/1/1 2/2/2 3/3/3\nf 1/ 3/ 4/\n",
                                  "f -4 -3 -2\nf -4 -2 -1\n", "f\t1\t2\t3\nf 1  3 \t4 \n", "f 1 2 \\\n 3\nf 1 3 \\\r\n4",
                                  "l 1 2\np 1\nusemtl a\nf 1 2 3 # comment \\\nf 1 3 4", "g x\ns off\nf 1 2\nf 1 2 3\nf +1 3 4", "fo 1 2 3\nf 1 3 4"})
    expect_square(read(points + faces, MeshFormat::Obj));
  expect_square(read("\xef\xbb\xbfv 0 0 0 1.0\nv\t1 0 0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\r\nf 1 2 3\rf 1 3 4", MeshFormat::Obj));
  expect_square(read("f 1 2 3\nf 1 3 4\n" + points, MeshFormat::Obj));  // forward references
  says(points + "f 1 2 5\n", MeshFormat::Obj, "out of range");
  says(points + "f 0 1 2\n", MeshFormat::Obj, "out of range");
  says(points + "f -5 1 2\n", MeshFormat::Obj, "out of range");
  says(points + "f 1 2 4294967297\n", MeshFormat::Obj, "out of range");
  says(points + "f 1 2 x\n", MeshFormat::Obj, "line 5: 'x' is not a face corner");
  says(points + "f 1 2 99999999999999999999\n", MeshFormat::Obj, "not a face corner");
  says("v 0 0\n", MeshFormat::Obj, "line 1: a vertex needs three coordinates");
  says("v 0 0 a\n", MeshFormat::Obj, "'a' is not a number");
  says("v 0 nan 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::Obj, "point 1");
  says(points, MeshFormat::Obj, "no faces");
  says(std::string("\0\1\2\3\\", 5), MeshFormat::Obj, "no faces");
}

TEST(PolygonSoup, OffForms) {
  const std::string body = "4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
  for (const std::string head : {"OFF\n", "OFF ", "", "# comment\nOFF # more\n\n", "COFF\n", "STCNOFF\n", "NOFF\n"})
    expect_square(read(head + body, MeshFormat::Off));
  expect_square(read("COFF\n4 2 5\n0 0 0 255 0 0 255\n1 0 0 1 0 0\n\n# between\n1 1 0 9\n0 1 0 # x\n3 0 1 2 255 0 0\n3 0 2 3 0.1 0.2 0.3 1.0\n",
                     MeshFormat::Off));
  expect_square(read("OFF\n4 2\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", MeshFormat::Off));
  says("OFF BINARY\n", MeshFormat::Off, "binary");
  says("4OFF\n" + body, MeshFormat::Off, "not supported");
  says("nonsense\n", MeshFormat::Off, "not an OFF file");
  says("OFF\n-4 2 0\n", MeshFormat::Off, "negative");
  says("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 4\n", MeshFormat::Off, "out of range");
  says("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n-3 0 2 3\n", MeshFormat::Off, "line 8: a face of -3 corners");
  says("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n1000000000 0 2 3\n", MeshFormat::Off, "corners");
  says("OFF\n4 0 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n", MeshFormat::Off, "no faces");
}

TEST(PolygonSoup, StlForms) {
  std::string upper = ascii_stl;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](char c) { return static_cast<char>(std::toupper(c)); });
  expect_square(read(upper, MeshFormat::Stl));
  expect_square(read("solid\n" + facet("0 0 0", "1 0 0", "1 1 0") + "endsolid\nsolid vertex facet\n" + facet("-0 0 0", "1 1 0", "0 1 0") + "endsolid",
                     MeshFormat::Stl));
  expect_square(read(binary_stl() + "a tail", MeshFormat::Stl));
  says(binary_stl().substr(0, 140), MeshFormat::Stl, "promises 2 facets");
  says("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", MeshFormat::Stl, "three coordinates");
  says("solid x\nendsolid x\n", MeshFormat::Stl, "no faces");
  std::string nan = binary_stl();
  nan.replace(84 + 12, 4, "\xff\xff\xff\xff");
  says(nan, MeshFormat::Stl, "not finite");
}

TEST(PolygonSoup, TruncatedFilesReadOrThrow) {
  const std::vector<std::pair<std::string, MeshFormat>> files{{ascii_ply, MeshFormat::Ply},
                                                              {binary_ply(false), MeshFormat::Ply},
                                                              {binary_ply(true), MeshFormat::Ply},
                                                              {ply_of_type<double>("double", "uint", false), MeshFormat::Ply},
                                                              {obj, MeshFormat::Obj},
                                                              {off, MeshFormat::Off},
                                                              {ascii_stl, MeshFormat::Stl},
                                                              {binary_stl(), MeshFormat::Stl}};
  for (const auto& [bytes, format] : files) {
    std::size_t accepted = 0;
    for (std::size_t n = 0; n <= bytes.size(); ++n) {
      const std::vector<char> exact(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n));  // a sanitizer sees every overrun
      try {
        const PolygonSoup soup = read_polygon_soup(std::string_view(exact.data(), exact.size()), format, "square");
        for (const std::int32_t v : soup.indices) ASSERT_TRUE(v >= 0 && v < static_cast<std::int32_t>(soup.points.size()));
        ++accepted;
      } catch (const Error& error) {
        EXPECT_NE(error.code(), ErrorCode::Internal);
      }
    }
    EXPECT_GE(accepted, 1u);
    // Of a binary body every byte is needed.
    if (format == MeshFormat::Ply && bytes.find("ascii") == bytes.npos && bytes.find("edge") == bytes.npos) {
      EXPECT_EQ(accepted, 1u);
    }
  }
}

TEST(PolygonSoup, DamagedFilesReadOrThrow) {
  const std::vector<std::pair<std::string, MeshFormat>> files{{ascii_ply, MeshFormat::Ply}, {binary_ply(false), MeshFormat::Ply},
                                                              {obj, MeshFormat::Obj},       {off, MeshFormat::Off},
                                                              {ascii_stl, MeshFormat::Stl}, {binary_stl(), MeshFormat::Stl}};
  TestRandom random(1);
  for (const auto& [bytes, format] : files)
    for (int round = 0; round < 2000; ++round) {
      std::string damaged = bytes;
      for (int i = random.below(4); i >= 0; --i) damaged[random.below(static_cast<int>(damaged.size()))] = static_cast<char>(random.below(256));
      message(damaged, format);
    }
}

TEST(PolygonSoup, FilesThatCannotBeRead) {
  Folder folder;
  const auto fails = [&](const std::string& path, ErrorCode code, const std::string& part) {
    try {
      read_polygon_soup(path);
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      EXPECT_EQ(std::string(error.what()).substr(0, path.size()), path);
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  fails(folder.file("none.ply"), ErrorCode::Io, "no such file");
  fails(folder.file("none.txt"), ErrorCode::Unsupported, "not a .ply, .obj, .off or .stl file");
  fs::create_directory(folder.file("folder.ply"));
  fails(folder.file("folder.ply"), ErrorCode::Io, "not a regular file");
  std::ofstream(folder.file("empty.obj")).close();
  fails(folder.file("empty.obj"), ErrorCode::InvalidInput, "empty");
}

TEST(PolygonSoup, ExtensionsOfAnyCase) {
  Folder folder;
  std::ofstream(folder.file("square.OBJ")) << obj;
  expect_square(read_polygon_soup(folder.file("square.OBJ")));
  std::ofstream(
      folder.file("qu\xc3\xa4"
                  "drat.Ply"))
      << ascii_ply;
  expect_square(
      read_polygon_soup(folder.file("qu\xc3\xa4"
                                    "drat.Ply")));
}

TEST(PolygonSoup, WritesWhatItReads) {
  Folder folder;
  PolygonSoup soup = cube();
  append(soup, grid(3, 2));
  PolygonSoup fine = soup;
  for (Vec3& p : fine.points) p = p / 3 + Vec3(1e-9, 1e9, -0.1);
  PolygonSoup large;  // more corners than a byte counts
  for (int i = 0; i < 300; ++i) {
    large.points.push_back({std::cos(i * 2 * M_PI / 300), std::sin(i * 2 * M_PI / 300), 0});
    large.indices.push_back(i);
  }
  large.offsets.push_back(300);
  for (const PolygonSoup* s : {&soup, &fine, &large})
    for (const std::string name : {"mesh.ply", "mesh.obj"}) {
      write_polygon_soup(*s, folder.file(name));
      const PolygonSoup back = read_polygon_soup(folder.file(name));
      EXPECT_EQ(back.points, s->points);
      EXPECT_EQ(back.indices, s->indices);
      EXPECT_EQ(back.offsets, s->offsets);
    }
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) files += entry.exists();
  EXPECT_EQ(files, 2u);  // nothing temporary is left
}

TEST(PolygonSoup, LeavesNothingBehindWhereItCannotWrite) {
  Folder folder;
  EXPECT_THROW(write_polygon_soup(cube(), folder.file("missing/mesh.ply")), Error);
  EXPECT_THROW(write_polygon_soup(cube(), folder.file("mesh.off")), Error);
  fs::create_directories(folder.file("taken.ply/inside"));
  try {
    write_polygon_soup(cube(), folder.file("taken.ply"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Io);
  }
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) files += entry.exists();
  EXPECT_EQ(files, 1u);
}

// A full disk is an error of its own and leaves no file.
TEST(PolygonSoup, ReportsAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  Folder folder;
  fs::create_symlink("/dev/full", folder.file("mesh.ply.part"));
  try {
    write_polygon_soup(grid(100, 100), folder.file("mesh.ply"));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Io);
    EXPECT_NE(std::string(error.what()).find("space"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(fs::exists(folder.file("mesh.ply")));
  EXPECT_FALSE(fs::is_symlink(folder.file("mesh.ply.part")));
}

}  // namespace
}  // namespace hybrid_mesh
