// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/container.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "hierarchy/bases.h"
#include "hierarchy/repatches.h"

namespace hybrid_mesh {
namespace {

namespace fs = std::filesystem;

// With all that a container holds: operations (one switched off), maps, positions of levels and of the final mesh.
HybridMesh full() {
  HybridMesh mesh = grid(3, 2);
  for (int q = 0; q < 6; ++q) {
    const int column = q % 3, row = q / 3;
    mesh.set_map(q, make_map(3, 0.2, q, [&](double u, double v) { return Vec3(column + u, row + v, 0.1 * u * v); }));
  }
  mesh.refine_uniform(1);
  for (int n : {1, 7, 9, 11}) mesh.refine_balanced(mesh.first_child(n % 6) + n % 4);
  EXPECT_EQ(mesh.apply(cube_on(mesh, mesh.first_child(mesh.first_child(1) + 1) + 2)), "");
  EXPECT_EQ(mesh.apply(opening(mesh, {mesh.first_child(4)})), "");
  mesh.balance();
  for (int root : mesh.operation(0).roots) mesh.set_map(root, make_map(2, 0.2, root, [&](double u, double v) { return Vec3(u, v, 1); }));
  mesh.set_level_positions(1, mesh.level_mesh(1));
  mesh.set_final_positions(mesh.final_mesh());
  EXPECT_EQ(mesh.set_enabled({true, false}), "");
  mesh.set_closure(FaceClosure::Transition);
  return mesh;
}

const char metadata[] = "{\"name\": \"K\xc3\xb6rper\"}";

void seal(std::vector<std::uint8_t>& bytes) {
  for (std::size_t at = 16; at + 24 <= bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 8], 8);
    if (length > bytes.size() - at - 24) break;
    const std::uint64_t checksum = container_checksum(bytes.data() + at + 24, length);
    std::memcpy(&bytes[at + 16], &checksum, 8);
    at += 24 + length;
  }
}

// Whether the bytes are a hierarchy; anything but Error is a failure of the test.
bool decodes(const std::vector<std::uint8_t>& bytes) {
  // From an allocation of exactly that size, so that a sanitizer sees every overrun.
  const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  try {
    const LoadedHierarchy loaded = decode_hierarchy(exact.get(), bytes.size());
    loaded.hierarchy.final_mesh();
    return true;
  } catch (const Error& error) {
    EXPECT_TRUE(error.code() == ErrorCode::CorruptStream || error.code() == ErrorCode::Unsupported);
    return false;
  }
}

TEST(Container, WhatIsSavedIsLoaded) {
  const HybridMesh mesh = full().canonical();  // operations by level
  const auto bytes = encode_hierarchy(mesh, metadata);
  EXPECT_EQ(encode_hierarchy(full(), metadata), bytes);
  const LoadedHierarchy loaded = decode_hierarchy(bytes.data(), bytes.size());
  EXPECT_EQ(loaded.metadata_json, metadata);
  EXPECT_TRUE(find_defects(loaded.hierarchy) == find_defects(mesh));
  EXPECT_EQ(loaded.hierarchy.enabled(), mesh.enabled());
  EXPECT_EQ(loaded.hierarchy.operation(1).repatch.kind, "add_cubes");
  EXPECT_EQ(loaded.hierarchy.closure(), FaceClosure::Transition);
  for (FaceClosure closure : {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles}) {
    const QuadMesh a = mesh.final_mesh(closure), b = loaded.hierarchy.final_mesh(closure);
    EXPECT_EQ(a.indices, b.indices);
    EXPECT_EQ(a.points, b.points);
  }
  for (int j = 0; j <= mesh.depth(); ++j) {
    const QuadMesh a = mesh.level_mesh(j, LevelKind::M), b = loaded.hierarchy.level_mesh(j, LevelKind::M);
    EXPECT_EQ(a.indices, b.indices);
    EXPECT_EQ(a.points, b.points);
  }
  EXPECT_EQ(encode_hierarchy(loaded.hierarchy, loaded.metadata_json), bytes);
}

TEST(Container, EveryBaseGoesThrough) {
  for (Base& base : bases()) {
    SCOPED_TRACE(base.name);
    base.mesh.refine_uniform(2);
    base.mesh.refine_balanced(base.mesh.leaves()[3]);
    const auto bytes = encode_hierarchy(base.mesh, "");
    const LoadedHierarchy loaded = decode_hierarchy(bytes.data(), bytes.size());
    EXPECT_EQ(loaded.hierarchy.final_mesh().indices, base.mesh.final_mesh().indices);
    EXPECT_TRUE(find_defects(loaded.hierarchy).empty());
    EXPECT_EQ(encode_hierarchy(loaded.hierarchy, ""), bytes);
  }
  const auto bytes = encode_hierarchy(HybridMesh(), "{}");
  EXPECT_EQ(decode_hierarchy(bytes.data(), bytes.size()).hierarchy.node_count(), 0);
}

TEST(Container, NoPrefixIsTakenForAFile) {
  auto bytes = encode_hierarchy(full(), metadata);
  ASSERT_TRUE(decodes(bytes));
  for (std::size_t n = 0; n < bytes.size(); ++n) ASSERT_FALSE(decodes({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)})) << n;
  bytes.push_back(0);
  EXPECT_FALSE(decodes(bytes));
}

TEST(Container, ChangedBytesAreRefused) {
  const auto bytes = encode_hierarchy(full(), metadata);
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    auto changed = bytes;
    changed[random() % changed.size()] ^= static_cast<std::uint8_t>(1u << (random() % 8));
    EXPECT_FALSE(decodes(changed));
  }
  auto other = bytes;
  other[0] = 'X';
  EXPECT_FALSE(decodes(other));
  other = bytes;
  other[8] = 2;
  try {
    decode_hierarchy(other.data(), other.size());
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
  }
}

// Past the checksums: an error or a hierarchy, but no crash and no endless memory.
TEST(Container, ForgedBytesDoNoHarm) {
  HybridMesh mesh = full();
  mesh.drop_maps();
  const auto plain = encode_hierarchy(mesh, "");
  mesh.clear_positions();
  const auto small = encode_hierarchy(mesh, "");
  std::mt19937 random(2);
  int valid = 0;
  for (int i = 0; i < 6000; ++i) {
    auto changed = i % 3 ? small : plain;
    const int changes = 1 + static_cast<int>(random() % 3);
    for (int c = 0; c < changes; ++c) {
      const std::size_t at = 16 + random() % (changed.size() - 16);
      switch (random() % 4) {
        case 0:
          changed[at] ^= static_cast<std::uint8_t>(1u << (random() % 8));
          break;
        case 1:
          changed[at] = static_cast<std::uint8_t>(random());
          break;
        case 2:
          changed[at] = 0xff;
          break;
        default:
          changed[at] += 1;
      }
    }
    seal(changed);
    valid += decodes(changed);
  }
  EXPECT_GT(valid, 0);
}

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("hybrid_mesh_container_" + std::to_string(std::random_device()()))) { fs::create_directories(path_); }
  ~Folder() { fs::remove_all(path_); }
  std::string file(const char* name) const { return (path_ / name).string(); }
  std::size_t entries() const { return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator())); }

 private:
  fs::path path_;
};

TEST(Container, FilesAreWrittenWholeOrNotAtAll) {
  const Folder folder;
  const HybridMesh mesh = full();
  save_hierarchy(mesh, metadata, folder.file("a.hmesh"));
  save_hierarchy(cube(), metadata, folder.file("a.hmesh"));  // over an earlier one
  save_hierarchy(mesh, metadata, folder.file("b.hmesh"));
  EXPECT_EQ(folder.entries(), 2u);
  EXPECT_EQ(load_hierarchy(folder.file("a.hmesh")).hierarchy.base_count(), 6);
  EXPECT_EQ(load_hierarchy(folder.file("b.hmesh")).hierarchy.operation_count(), 2);
  const auto fails = [](const auto& action) {
    try {
      action();
    } catch (const Error& error) {
      return error.code() == ErrorCode::Io;
    }
    return false;
  };
  fs::create_directories(folder.file("folder.hmesh/inside"));
  EXPECT_TRUE(fails([&] { save_hierarchy(mesh, metadata, folder.file("folder.hmesh")); }));
  EXPECT_TRUE(fails([&] { save_hierarchy(mesh, metadata, folder.file("missing/a.hmesh")); }));
  EXPECT_TRUE(fails([&] { load_hierarchy(folder.file("none.hmesh")); }));
  EXPECT_TRUE(fails([&] { load_hierarchy(folder.file("folder.hmesh")); }));
  EXPECT_EQ(folder.entries(), 3u);
}

}  // namespace
}  // namespace hybrid_mesh
