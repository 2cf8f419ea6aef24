// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh_formats.h"

#include <gtest/gtest.h>

#include <cctype>

#include "surface/square_files.h"

namespace hybrid_mesh {
namespace {

TEST(MeshFormats, PlyHeadersWithEveryLineEnd) {
  for (const bool big : {false, true})
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      const std::string bytes = binary_ply(big);
      const std::size_t body = bytes.find("end_header\n") + 11;
      std::string header = bytes.substr(0, body), changed;
      for (const char c : header) changed += c == '\n' ? end : std::string(1, c);
      expect_square(read(changed + bytes.substr(body), MeshFormat::Ply));
    }
}

TEST(MeshFormats, PlyOfEveryTypeAndWithOtherElementsAndProperties) {
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

TEST(MeshFormats, PlyStripsAndFacesBeforeVertices) {
  const PolygonSoup strips =
      read("ply\nformat ascii 1.0\n" + ply_vertices +
               "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 3 2 1\n",
           MeshFormat::Ply);
  EXPECT_EQ(strips.indices, (std::vector<std::int32_t>{0, 1, 2, 2, 1, 3, 3, 2, 1}));
  expect_square(
      read("ply\nformat ascii 1.0\n" + ply_faces + ply_vertices + "end_header\n3 0 1 2\n3 0 2 3\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n", MeshFormat::Ply));
}

TEST(MeshFormats, PlyRefusals) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = ascii_ply;
    return text.replace(text.find(from), from.size(), to);
  };
  says("", MeshFormat::Ply, "empty");
  says("plyx\n", MeshFormat::Ply, "not a PLY file");
  says("ply\nformat ascii 1.0\nelement vertex 4\n", MeshFormat::Ply, "header does not end");
  says("ply\nelement vertex 4\nend_header\n", MeshFormat::Ply, "no format line");
  says(with("3 0 2 3", "3 0 2 4"), MeshFormat::Ply, "face 2 has a point index out of range");
  says(with("3 0 2 3", "3 0 2 -1"), MeshFormat::Ply, "out of range");
  says(with("3 0 2 3", "3 0 2 99999999999"), MeshFormat::Ply, "out of range");
  says(with("3 0 2 3", "3 0 x 3"), MeshFormat::Ply, "line 15: damaged at 'face' 2 of 2: 'x' is not a number");
  says(with("3 0 2 3", "-3 0 2 3"), MeshFormat::Ply, "damaged at 'face' 2");
  says(with("3 0 2 3", "1000000000 0 2 3"), MeshFormat::Ply, "damaged at 'face' 2");
  says(with("1 1 0", "1 nan 0"), MeshFormat::Ply, "point 3 has a coordinate that is not finite");
  says(with("1 1 0", "1 inf 0"), MeshFormat::Ply, "not finite");
  says(with("1 1 0", "1 1e999 0"), MeshFormat::Ply, "not finite");
  says(with("format ascii", "format binary_middle_endian"), MeshFormat::Ply, "unknown format");
  says(with("property float x\n", ""), MeshFormat::Ply, "lacks the properties x, y and z");
  says(with("list uchar int vertex_indices", "int vertex_indices"), MeshFormat::Ply, "lacks the property vertex_indices");
  says(with("list uchar int vertex_indices", "list uchar float corners"), MeshFormat::Ply, "lacks the property vertex_indices");
  says(with("vertex_indices\n", "a\nproperty list uchar int b\n"), MeshFormat::Ply, "no other list");
  says(with("property float x", "property quad x"), MeshFormat::Ply, "bad header line");
  says(with("element vertex 4", "element vertex -4"), MeshFormat::Ply, "bad header line");
  says(with("element face 2\n", "element face 0\n").substr(0, ascii_ply.find("3 0 1 2")), MeshFormat::Ply, "no faces");
  EXPECT_NE(message(with("3 0 1 2\n3 0 2 3\n", "2 0 1\n1 0\n"), MeshFormat::Ply).find("no faces"), std::string::npos);
  EXPECT_EQ(message(with("1 1 0", "1 1e-999 0"), MeshFormat::Ply), "");
}

TEST(MeshFormats, RefusesImpossibleCountsAtOnce) {
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

TEST(MeshFormats, ObjForms) {
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

TEST(MeshFormats, OffForms) {
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

TEST(MeshFormats, StlForms) {
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

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), text.npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

// As UTF-16, for ASCII and characters that are given as units.
std::string utf16(const std::u16string& text, bool big) {
  std::string bytes;
  for (const char16_t unit : text) bytes += raw(static_cast<std::uint16_t>(unit), big);
  return bytes;
}
std::u16string wide(const std::string& text) { return {text.begin(), text.end()}; }

TEST(MeshFormats, PlyHeadersAsProgramsWriteThem) {
  for (const std::string& bytes : {ascii_ply, binary_ply(false), binary_ply(true)})
    for (const std::string line :
         {"comment element face 9", "comment", "obj_info num_cols 512", "", "   ", "VCGLIB generated", "created by: a program 1.0"})
      for (const std::string before : {"element vertex", "property float y", "element face", "end_header"})
        expect_square(read(replaced(bytes, before, line + "\n" + before), MeshFormat::Ply));
  std::string blanks;
  for (const char c : ascii_ply) blanks += c == '\n' ? " \t\r\n" : std::string(1, c);
  expect_square(read(blanks, MeshFormat::Ply));
  for (const std::string word : {"ply", "end_header"}) expect_square(read(replaced(binary_ply(true), word, word + "  "), MeshFormat::Ply));
}

TEST(MeshFormats, PlyLinesThatAreNoneAreNamedWhereSomethingIsLost) {
  for (const std::string& bytes : {ascii_ply, binary_ply(false)}) {
    says(replaced(bytes, "property list", "propery list"), MeshFormat::Ply, "lacks");
    says(replaced(bytes, "property float z", "propery float z"), MeshFormat::Ply, "lacks");
    says(replaced(bytes, "element face", "elment face"), MeshFormat::Ply, "the line 'elment face 2' of the header was skipped");
  }
  const std::string flags = "property uchar flag\n";
  const std::string flagged = replaced(replaced(replaced(ascii_ply, ply_faces, ply_faces + flags), "3 0 1 2", "3 0 1 2 0"), "3 0 2 3", "3 0 2 3 0");
  expect_square(read(flagged, MeshFormat::Ply));
  says(replaced(flagged, flags, "propety uchar flag\n"), MeshFormat::Ply, "the line 'propety uchar flag' of the header was skipped");
}

TEST(MeshFormats, PlyFaceListsOfOtherNames) {
  for (const std::string name : {"vertex_index", "vertex_indices", "vertex_ids", "vertices", "vertIndices", "corners", "indices"})
    for (const std::string& bytes : {ascii_ply, binary_ply(false), binary_ply(true)})
      expect_square(read(replaced(bytes, "vertex_indices", name), MeshFormat::Ply));
  const std::string text = "ply\nformat ascii 1.0\n" + ply_vertices + "element face 2\n";
  const std::string points = "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  // Beside lists of something else, whatever comes first.
  expect_square(read(text + "property list uchar int material_indices\nproperty list uchar int vertex_ids\n" + points + "1 9 3 0 1 2\n1 9 3 0 2 3\n",
                     MeshFormat::Ply));
  expect_square(
      read(text + "property list uchar int corners\nproperty list uchar float texcoord\n" + points + "3 0 1 2 1 9\n3 0 2 3 1 9\n", MeshFormat::Ply));
  expect_square(read(text + "property list uchar int vertex_index\nproperty list uchar int vertex_indices\n" + points + "3 0 1 2 1 9\n3 0 2 3 1 9\n",
                     MeshFormat::Ply));
  expect_square(read(text + "property list uchar float vertex_index\n" + points + "3 0.0 1 2.0\n3 0 2e0 3\n", MeshFormat::Ply));
  says(text + "property list uchar float vertex_index\n" + points + "3 0 1 2\n3 0 1.5 3\n", MeshFormat::Ply, "out of range");
}

TEST(MeshFormats, PlyOf64Bits) {
  for (const bool big : {false, true}) {
    std::string bytes = "ply\nformat binary_" + std::string(big ? "big" : "little") + "_endian 1.0\n" + ply_vertices +
                        "element face 2\nproperty list uint64 int64 vertex_indices\nend_header\n";
    for (const float c : {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) bytes += raw(c, big);
    for (const std::int64_t i : {3, 0, 1, 2, 3, 0, 2, 3}) bytes += raw(i, big);
    expect_square(read(bytes, MeshFormat::Ply));
    const std::size_t last = bytes.size() - 8;
    says(bytes.substr(0, last) + raw(std::int64_t{1} << 32, big), MeshFormat::Ply, "out of range");
    says(bytes.substr(0, last - 24) + raw(~std::uint64_t{0}, big) + bytes.substr(last - 16), MeshFormat::Ply, "a list of -1");
  }
}

// What is wrong is named with the line, or the byte of a binary file, where it stands.
TEST(MeshFormats, ErrorsNameThePlace) {
  says(replaced(ascii_ply, "1 1 0", "1 nan 0"), MeshFormat::Ply, "line 12: point 3 has a coordinate that is not finite (nan)");
  says(replaced(ascii_ply, "3 0 2 3", "3 0 2 7"), MeshFormat::Ply, "line 15: face 2 has a point index out of range (there are 4 points)");
  says(replaced(ascii_ply, "element vertex 4", "element vertex four"), MeshFormat::Ply, "line 3: bad header line");
  says(binary_ply(true).substr(0, binary_ply(true).size() - 6), MeshFormat::Ply, "damaged at 'face' 2 of 2: a list of 3, more than");
  says(replaced(ascii_ply, "3 0 2 3\n", "3 0 2\n"), MeshFormat::Ply, "truncated: the file ends at 'face' 2 of 2");
  const std::string binary = binary_ply(false);
  const std::size_t body = binary.find("end_header\n") + 11;
  std::string damaged = binary;
  damaged.replace(body + 24, 4, raw(std::numeric_limits<float>::infinity(), false));
  says(damaged, MeshFormat::Ply, "byte " + std::to_string(body + 36) + ": point 3 has a coordinate that is not finite (inf)");
  says(binary.substr(0, binary.size() - 4) + raw(std::int32_t{4}, false), MeshFormat::Ply, "byte " + std::to_string(binary.size()) + ": face 2");
  says(replaced(obj, "f 1 3 4", "f 1 3 5"), MeshFormat::Obj, "line 7: face 2 has a point index out of range");
  says("f 1 2 3\nf 1 9 3\n" + obj, MeshFormat::Obj, "line 2: face 2 has a point index out of range (there are 4 points)");
  says(replaced(obj, "v 1 1 0", "v 1 -inf 0"), MeshFormat::Obj, "line 4: point 3 has a coordinate that is not finite (-inf)");
  says(replaced(off, "3 0 2 3", "3 0 2 4"), MeshFormat::Off, "line 8: face 2 has a point index out of range");
  says(replaced(off, "1 1 0", "1 1e999 0"), MeshFormat::Off, "line 5: point 3");
  says(off.substr(0, off.find("3 0 2")), MeshFormat::Off, "truncated: the file ends where a number of corners should be");
  says(replaced(ascii_stl, "1 1 0", "1 nan 0"), MeshFormat::Stl, "line 6: point 3 has a coordinate that is not finite (nan)");
  says(replaced(ascii_stl, "1 1 0", "1 -nan(ind) 0"), MeshFormat::Stl, "line 6: point 3 has a coordinate that is not finite (nan)");
  std::string infinite = binary_stl();
  infinite.replace(84 + 24, 4, raw(-std::numeric_limits<float>::infinity(), false));
  says(infinite, MeshFormat::Stl, "byte 108: point 2 has a coordinate that is not finite (-inf)");
}

// A count that is too small would lose surface, or take a point for a face.
TEST(MeshFormats, CountsThatAreTooSmall) {
  for (const std::string& bytes : {ascii_ply, binary_ply(false), binary_ply(true)}) {
    says(replaced(bytes, "element face 2", "element face 1"), MeshFormat::Ply, "the file goes on after");
    for (const std::string tail : {"\n", "\r\n\x1a", " \n \n"}) expect_square(read(bytes + tail, MeshFormat::Ply));
    expect_square(read(bytes + std::string(100, '\0'), MeshFormat::Ply));
  }
  says(replaced(ascii_ply, "vertex 4", "vertex 3"), MeshFormat::Ply, "the file goes on after");
  says(replaced(off, "4 2 0", "4 1 0"), MeshFormat::Off, "line 8: the file goes on after the 4 points and 1 faces");
  says(replaced(off, "4 2 0", "3 2 0"), MeshFormat::Off, "the file goes on after");
  expect_square(read(off + "# the end\n\x1a", MeshFormat::Off));
  std::string stl = binary_stl();
  stl[80] = 1;
  says(stl, MeshFormat::Stl, "promises 1 facets, and there is room for 2");
  expect_square(read(binary_stl() + std::string(428, '\0'), MeshFormat::Stl));
}

TEST(MeshFormats, OffHeads) {
  const std::string body = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
  for (const std::string head :
       {"OFF 4 2 5\n", "OFF4 2 5\n", "OFF\t4 2\n", "off\n4 2 0\n", "\n\n# made by\n OFF \n\n # counts\n\n  4 2 0 # that is all\n\n", "4 2 0\n",
        "# no keyword\n\n4 2 0\n", "COFF 4 2 0\n", "NCOFF\n4 2 0\n", "STOFF4 2 0\n", "\xef\xbb\xbfOFF 4 2 0\n"})
    expect_square(read(head + body, MeshFormat::Off));
  expect_square(read("NOFF\n4 2 0\n0 0 0  0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n3 0 2 3\n", MeshFormat::Off));
  says("4OFF\n4 2 0\n" + body, MeshFormat::Off, "four coordinates");
  says("ST4OFF 4 2 0\n" + body, MeshFormat::Off, "four coordinates");
  says("nOFF\n3\n4 2 0\n" + body, MeshFormat::Off, "any number of coordinates");
  says("OFF BINARY\n" + body, MeshFormat::Off, "binary");
  says("OFFER\n4 2 0\n" + body, MeshFormat::Off, "line 1: 'ER' is not the number of points");
  says("CAFE\n4 2 0\n" + body, MeshFormat::Off, "not an OFF file");
  says("OFF\n", MeshFormat::Off, "truncated: the file ends where the number of points");
}

TEST(MeshFormats, TextInUtf16) {
  const std::u16string name = u"g \u732b \xd83d\xde00\n", half = u"g \xd83d\n";
  for (const bool big : {false, true})
    for (const std::u16string mark : {u"\xfeff", u""}) {
      expect_square(read(utf16(mark + wide("#") + name + wide(obj), big), MeshFormat::Obj));
      expect_square(read(utf16(mark + wide(with_carriage(obj)) + half, big), MeshFormat::Obj));
      expect_square(read(utf16(mark + wide(off), big), MeshFormat::Off));
      expect_square(read(utf16(mark + wide(ascii_ply), big), MeshFormat::Ply));
      expect_square(read(utf16(mark + wide(ascii_stl), big), MeshFormat::Stl));
      says(utf16(mark + wide(replaced(obj, "f 1 3 4", "f 1 x 4")), big), MeshFormat::Obj, "line 7: 'x' is not a face corner");
      expect_square(read(utf16(mark + wide(obj), big) + "x", MeshFormat::Obj));  // half a character at the end
    }
  says("\xff\xfe", MeshFormat::Obj, "no faces");
  for (const std::string& text : {obj, off, ascii_ply, ascii_stl})
    expect_square(read("\xef\xbb\xbf" + text, text == obj         ? MeshFormat::Obj
                                              : text == off       ? MeshFormat::Off
                                              : text == ascii_ply ? MeshFormat::Ply
                                                                  : MeshFormat::Stl));
}

// A name may end in a backslash (of a path, or the second byte of a character in Shift-JIS): only lines of numbers go on after one.
TEST(MeshFormats, ObjNamesInAnyEncoding) {
  for (const std::string name : {"g \x95\x5c", "o caf\xe9", "usemtl \xe7\x8c\xab", "mtllib C:\\models\\", "# C:\\models\\", "g \xff\xfe\x80 \\"})
    for (const std::string end : {"\n", "\r\n", "\r"})
      for (const std::string before : {"v 0 0 0", "f 1 2 3"}) expect_square(read(replaced(obj, before, name + end + before), MeshFormat::Obj));
  expect_square(read("v 0 \\\n0 0\nv 1 0 0 \\\r\n 0.5 0.5 0.5\nv 1 1 0 1.0\nv 0 1 0 255 0 0\nf 1 \\\n2 \\\n3\nf 1\\\n 3 4 \\\n", MeshFormat::Obj));
}

TEST(MeshFormats, StlOfSeveralSolids) {
  const std::string first = facet("0 0 0", "1 0 0", "1 1 0"), second = facet("0 0 0", "1 1 0", "0 1 0");
  for (const std::string name : {"", " ", " two words", " caf\xe9 (v1)", " facet normal", " solid"})
    expect_square(read("solid" + name + "\n" + first + "endsolid" + name + "\n\nsolid" + name + "\r\n" + second + "endsolid\n\x1a", MeshFormat::Stl));
  expect_square(read(replaced(ascii_stl, "normal 0 0 1", "normal nan nan nan"), MeshFormat::Stl));  // normals are not looked at
  says(ascii_stl.substr(0, ascii_stl.find("endsolid")), MeshFormat::Stl, "line 16: truncated: the solid does not end");
  says(replaced(ascii_stl, "vertex 1 1 0", "vertex 1,5 1 0"), MeshFormat::Stl, "line 6: '1,5' is not a number");
}

}  // namespace
}  // namespace hybrid_mesh
