// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "base/error.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {
namespace {

const std::string kHeader =
    "element vertex 3\nproperty float x\nproperty uchar red\nproperty float y\nproperty uchar green\nproperty float z\n"
    "property uchar blue\nproperty ushort fine\nproperty double quality\nproperty list uchar int loose\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kText = "ply\nformat ascii 1.0\n" + kHeader +
                          "0 255 0 0 0 0 65535 0.25 1 7\n"
                          "1 0 0 255 0 0 0 -2 0\n"
                          "0 51 1 51 0 51 13107 0.5 2 8 9\n"
                          "3 0 1 2\n";

template <class T>
std::string raw(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string binary() {
  std::string bytes = "ply\nformat binary_little_endian 1.0\n" + kHeader;
  const double quality[3] = {0.25, -2, 0.5};
  const std::uint16_t fine[3] = {65535, 0, 13107};
  const std::uint8_t colors[3][3] = {{255, 0, 0}, {0, 255, 0}, {51, 51, 51}};
  const float places[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int v = 0; v < 3; ++v) {
    for (int i = 0; i < 3; ++i) bytes += raw(places[v][i]) + raw(colors[v][i]);
    bytes += raw(fine[v]) + raw(quality[v]) + raw<std::uint8_t>(1) + raw<std::int32_t>(7);
  }
  return bytes + raw<std::uint8_t>(3) + raw<std::int32_t>(0) + raw<std::int32_t>(1) + raw<std::int32_t>(2);
}

std::vector<double> density(const std::string& bytes, const std::string& name) {
  const PolygonSoup soup = read_polygon_soup(bytes, MeshFormat::Ply, "file.ply", name);
  EXPECT_EQ(soup.points.size(), 3u);
  return soup.density;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], wanted[i], 1e-12);
}

std::string refusal(const std::string& bytes, MeshFormat format, const std::string& name) {
  try {
    read_polygon_soup(bytes, format, "file", name);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(PlyDensity, IsAnyNumberOfAVertex) {
  for (const std::string& bytes : {kText, binary()}) {
    EXPECT_TRUE(density(bytes, "").empty());
    expect_near(density(bytes, "quality"), {0.25, -2, 0.5});
    expect_near(density(bytes, "red"), {1, 0, 0.2});
    expect_near(density(bytes, "fine"), {1, 0, 0.2});
    expect_near(density(bytes, "color"), {0.2126, 0.7152, 0.2});
  }
}

TEST(PlyDensity, ThatIsNotThereIsRefusedWithWhatThereIs) {
  for (const std::string name : {"weight", "x", "loose", "vertex_indices"}) {
    const std::string what = refusal(kText, MeshFormat::Ply, name);
    EXPECT_NE(what.find("no property '" + name + "' for the density"), std::string::npos) << what;
    EXPECT_NE(what.find("red, green, blue, fine, quality"), std::string::npos) << what;
  }
  const std::string plain =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  EXPECT_NE(refusal(plain, MeshFormat::Ply, "color").find("no property 'color'"), std::string::npos);
}

TEST(PlyDensity, IsReadOfNoOtherFormat) {
  EXPECT_NE(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", MeshFormat::Obj, "weight").find("'weight'"), std::string::npos);
}

TEST(PlyDensity, ThatEndsTooSoonIsDamage) {
  const std::string bytes = binary();
  for (std::size_t size = bytes.find("end_header"); size < bytes.size(); ++size)
    EXPECT_FALSE(refusal(bytes.substr(0, size), MeshFormat::Ply, "quality").empty()) << size;
}

}  // namespace
}  // namespace hybrid_mesh
