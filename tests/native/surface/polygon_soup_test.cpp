// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/polygon_soup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/error.h"
#include "shapes.h"
#include "surface/square_files.h"

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

// What the fuzzers start from is what is odd in real files.
TEST(PolygonSoup, EveryPrefixOfAnOddFileReadsOrThrows) {
  const fs::path seeds = fs::path(HYBRID_MESH_CHECKOUT) / "tests/native/fuzz/seeds";
  int read = 0;
  for (const auto& [format, name] :
       {std::pair(MeshFormat::Ply, "ply"), std::pair(MeshFormat::Obj, "obj"), std::pair(MeshFormat::Off, "off"), std::pair(MeshFormat::Stl, "stl")})
    for (const auto& entry : fs::directory_iterator(seeds / ("read_" + std::string(name) + "_fuzz"))) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
      ASSERT_FALSE(bytes.empty()) << entry.path();
      for (std::size_t n = 0; n < bytes.size(); ++n) message(bytes.substr(0, n), format);
      const std::string whole = message(bytes, format);
      EXPECT_TRUE(whole.empty() || whole.find("four coordinates") != whole.npos) << entry.path() << ": " << whole;
      ++read;
    }
  EXPECT_GT(read, 15);
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
