// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/reader/hybrid_mesh_decoder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "codec/stream.h"
#include "hierarchy/bases.h"

namespace hybrid_mesh {
namespace {

std::vector<std::uint8_t> stream() {
  HybridMesh mesh = torus(3, 3);
  mesh.refine_uniform(3);
  QuadMesh final = mesh.final_mesh();
  for (std::size_t v = 0; v < final.points.size(); ++v) {
    const auto x = static_cast<double>(v);
    final.points[v] = Vec3(std::sin(x), std::cos(2 * x), std::sin(0.3 * x));
  }
  mesh.set_final_positions(final);
  Context context;
  return encode_stream(mesh, {}, Progress(context));
}

void expect_level(const hybrid_mesh_decoder* decoder, const QuadMesh& expected) {
  ASSERT_EQ(hybrid_mesh_decoder_vertex_count(decoder), expected.vertex_count());
  ASSERT_EQ(hybrid_mesh_decoder_face_count(decoder), expected.face_count());
  EXPECT_TRUE(std::equal(expected.offsets.begin(), expected.offsets.end(), hybrid_mesh_decoder_offsets(decoder)));
  EXPECT_TRUE(std::equal(expected.indices.begin(), expected.indices.end(), hybrid_mesh_decoder_indices(decoder)));
  for (std::size_t v = 0; v < expected.vertex_count(); ++v)
    for (int i = 0; i < 3; ++i) ASSERT_EQ(hybrid_mesh_decoder_points(decoder)[3 * v + i], expected.points[v][i]);
}

TEST(HybridMeshDecoder, HasEveryLevelOfEveryPrefix) {
  const std::vector<std::uint8_t> bytes = stream();
  hybrid_mesh_decoder* decoder = hybrid_mesh_decoder_open(bytes.data(), bytes.size());
  ASSERT_NE(decoder, nullptr);
  for (const std::size_t size : {bytes.size(), bytes.size() / 3, bytes.size() / 10}) {
    const HybridMesh mesh = decode_stream(bytes.data(), size);
    for (int level = 0; level <= mesh.depth(); ++level) {
      ASSERT_EQ(hybrid_mesh_decoder_decode(decoder, size, level), HYBRID_MESH_OK) << hybrid_mesh_decoder_error(decoder);
      EXPECT_EQ(hybrid_mesh_decoder_level(decoder), level);
      EXPECT_EQ(hybrid_mesh_decoder_depth(decoder), mesh.depth());
      expect_level(decoder, mesh.level_mesh(level));
    }
    ASSERT_EQ(hybrid_mesh_decoder_decode(decoder, size, -1), HYBRID_MESH_OK);
    expect_level(decoder, mesh.final_mesh());
  }
  hybrid_mesh_decoder_close(decoder);
}

TEST(HybridMeshDecoder, RefusesInWords) {
  const std::vector<std::uint8_t> bytes = stream();
  hybrid_mesh_decoder* decoder = hybrid_mesh_decoder_open(bytes.data(), 6);
  EXPECT_EQ(hybrid_mesh_decoder_decode(decoder, 0, -1), HYBRID_MESH_CORRUPT);
  EXPECT_NE(std::string(hybrid_mesh_decoder_error(decoder)).find("base"), std::string::npos);
  EXPECT_EQ(hybrid_mesh_decoder_points(decoder), nullptr);
  EXPECT_EQ(hybrid_mesh_decoder_vertex_count(decoder), 0u);
  ASSERT_EQ(hybrid_mesh_decoder_append(decoder, bytes.data() + 6, bytes.size() - 6), HYBRID_MESH_OK);
  EXPECT_EQ(hybrid_mesh_decoder_decode(decoder, 0, -2), HYBRID_MESH_INVALID);
  ASSERT_EQ(hybrid_mesh_decoder_limit(decoder, 700), HYBRID_MESH_OK);
  EXPECT_EQ(hybrid_mesh_decoder_decode(decoder, 0, -1), HYBRID_MESH_CORRUPT);
  ASSERT_EQ(hybrid_mesh_decoder_limit(decoder, 9 * 85), HYBRID_MESH_OK);
  EXPECT_EQ(hybrid_mesh_decoder_decode(decoder, 0, -1), HYBRID_MESH_OK) << hybrid_mesh_decoder_error(decoder);
  EXPECT_STREQ(hybrid_mesh_decoder_error(decoder), "");
  hybrid_mesh_decoder_close(decoder);
  hybrid_mesh_decoder_close(nullptr);
  EXPECT_EQ(hybrid_mesh_decoder_decode(nullptr, 0, -1), HYBRID_MESH_INVALID);
}

}  // namespace
}  // namespace hybrid_mesh
