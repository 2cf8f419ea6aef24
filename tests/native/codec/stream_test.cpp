// SPDX-License-Identifier: GPL-3.0-or-later
#include "codec/stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "base/error.h"
#include "decoder/bits/bit_models.h"
#include "decoder/planes/base_points.h"
#include "hierarchy/bases.h"
#include "hierarchy/repatches.h"

namespace hybrid_mesh {
namespace {

using Bytes = std::vector<std::uint8_t>;

Context context;

Bytes encoded(const HybridMesh& mesh, const StreamOptions& options = {}) { return encode_stream(mesh, options, Progress(context)); }

// From an allocation of exactly that size, so that a sanitizer sees every overrun.
HybridMesh decoded(const Bytes& bytes) {
  const std::unique_ptr<std::uint8_t[]> exact(new std::uint8_t[bytes.size()]);
  std::copy(bytes.begin(), bytes.end(), exact.get());
  return decode_stream(exact.get(), bytes.size());
}

Bytes prefix(const Bytes& bytes, std::size_t size) { return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}; }

// Whether the bytes are a stream; anything but an Error for bad bytes is a failure of the test.
bool decodes(const Bytes& bytes) {
  try {
    const QuadMesh mesh = decoded(bytes).final_mesh();
    for (const Vec3& point : mesh.points) EXPECT_TRUE(point.allFinite());
    return true;
  } catch (const Error& error) {
    EXPECT_TRUE(error.code() == ErrorCode::CorruptStream || error.code() == ErrorCode::Unsupported) << error.what();
    return false;
  }
}

// Puts the final mesh on a shape without symmetries.
void give_positions(HybridMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  QuadMesh final = mesh.final_mesh();
  std::map<VertexId, Vec3> base;
  for (int i = 0; i < 64; ++i) base[VertexId(VertexId::Kind::Free, i)] = Vec3(uniform(random), uniform(random), uniform(random));
  for (std::size_t v = 0; v < final.points.size(); ++v) {
    const auto known = base.find(final.vertex[v]);
    Vec3 point = known != base.end() ? known->second : Vec3(uniform(random), uniform(random), uniform(random));
    if (mesh.has_maps()) point = mesh.sample(final.vertex[v]).position + 0.02 * point;
    final.points[v] = 7 * point + Vec3(100, -20, 3);
  }
  mesh.set_final_positions(final);
}

void give_maps(HybridMesh& mesh) {
  for (int q = 0; q < mesh.base_count(); ++q) {
    const int column = q % 3, row = q / 3;
    mesh.set_map(q, make_map(2, 0, 1, [&](double u, double v) { return Vec3(column + u, row + v, 0.4 * std::sin(2 * u + q) * std::cos(v)); }));
  }
}

struct Sample {
  std::string name;
  HybridMesh mesh;
};

std::vector<Sample> samples() {
  std::vector<Sample> result;
  for (auto& base : bases()) {
    base.mesh.refine_uniform(2);
    result.push_back({base.name, base.mesh});
  }
  HybridMesh flat = grid(3, 2);
  result.push_back({"a base alone", flat});
  flat.set_sharp(1, 0);
  flat.set_sharp(2, 3);
  give_maps(flat);
  flat.refine_uniform(3);
  result.push_back({"sharp sides", flat});
  for (const FaceClosure closure : {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles}) {
    HybridMesh mesh = torus(3, 3);
    mesh.refine_uniform(1);
    for (int n : {1, 4, 7}) mesh.refine_balanced(mesh.first_child(n) + n % 4);
    mesh.refine_balanced(mesh.first_child(mesh.first_child(4)) + 1);
    mesh.set_closure(closure);
    result.push_back({"adaptive", mesh});
  }
  HybridMesh changed = grid(3, 2);
  changed.refine_uniform(1);
  EXPECT_EQ(changed.apply(cube_on(changed, changed.first_child(1) + 1)), "");
  EXPECT_EQ(changed.apply(opening(changed, {changed.first_child(4)})), "");
  changed.refine_uniform(2);
  EXPECT_EQ(changed.apply(tube_between(changed, changed.first_child(changed.first_child(0)), changed.first_child(changed.first_child(5) + 2), 1)),
            "");
  result.push_back({"operations", changed});
  changed.refine_uniform(3);
  result.push_back({"operations below", changed});
  HybridMesh both = grid(3, 2);
  both.refine_uniform(2);
  EXPECT_EQ(both.apply(cube_on(both, both.first_child(both.first_child(1) + 2) + 1)), "");
  both.refine_balanced(both.operation(0).roots[2]);
  both.balance();
  result.push_back({"adaptive with operations", both});
  for (std::size_t i = 0; i < result.size(); ++i) give_positions(result[i].mesh, static_cast<unsigned>(i));
  return result;
}

// Faces as the sets of rounded places of their corners, in an order of their own.
std::vector<std::vector<std::array<long, 3>>> faces_by_place(const QuadMesh& mesh, const std::vector<Vec3>& points) {
  std::vector<std::vector<std::array<long, 3>>> faces;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    auto& face = faces.emplace_back();
    for (auto c = mesh.offsets[f]; c < mesh.offsets[f + 1]; ++c) {
      const Vec3& p = points[mesh.indices[c]];
      face.push_back({std::lround(p.x() * 1e4), std::lround(p.y() * 1e4), std::lround(p.z() * 1e4)});
    }
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

// The other mesh's points put where the nearest ones of the first are, so that rounding is no matter. Returns how far that is.
double snap(const std::vector<Vec3>& to, std::vector<Vec3>& points) {
  double farthest = 0;
  for (Vec3& point : points) {
    const Vec3* nearest = &to[0];
    for (const Vec3& other : to)
      if ((other - point).squaredNorm() < (*nearest - point).squaredNorm()) nearest = &other;
    farthest = std::max(farthest, (*nearest - point).norm());
    point = *nearest;
  }
  return farthest;
}

double diagonal(const std::vector<Vec3>& points) {
  Vec3 low = points[0], high = points[0];
  for (const Vec3& point : points) low = low.cwiseMin(point), high = high.cwiseMax(point);
  return (high - low).norm();
}

TEST(Stream, TheWholeOfItHasTheFinalMesh) {
  for (const auto& [name, mesh] : samples()) {
    SCOPED_TRACE(name);
    const HybridMesh back = decoded(encoded(mesh));
    EXPECT_TRUE(find_defects(back).empty());
    const QuadMesh before = mesh.final_mesh();
    QuadMesh after = back.final_mesh();
    ASSERT_EQ(after.vertex_count(), before.vertex_count());
    EXPECT_LT(snap(before.points, after.points), 1e-6 * diagonal(before.points));
    EXPECT_EQ(faces_by_place(after, after.points), faces_by_place(before, before.points));
    EXPECT_EQ(back.closure(), mesh.closure());
  }
}

// Level by level: with each level's vertices where the final mesh has those of the same name.
TEST(Stream, EveryLevelHasItsConnectivity) {
  for (const auto& [name, mesh] : samples()) {
    SCOPED_TRACE(name);
    const HybridMesh back = decoded(encoded(mesh));
    ASSERT_EQ(back.depth(), mesh.depth());
    ASSERT_EQ(back.operation_count(), mesh.operation_count());
    for (int j = 0; j <= mesh.depth(); ++j)
      for (const LevelKind kind : {LevelKind::M, LevelKind::N}) {
        const QuadMesh a = mesh.level_mesh(j, kind), b = back.level_mesh(j, kind);
        const SoupTopology before = soup_topology(a), after = soup_topology(b);
        EXPECT_EQ(after.vertices, before.vertices);
        EXPECT_EQ(after.faces, before.faces);
        EXPECT_EQ(after.euler, before.euler);
        EXPECT_EQ(after.boundary_loops, before.boundary_loops);
        EXPECT_EQ(std::count(b.sharp.begin(), b.sharp.end(), 1), std::count(a.sharp.begin(), a.sharp.end(), 1));
      }
  }
}

TEST(Stream, EveryPrefixDecodesOrIsRefused) {
  for (const auto& [name, mesh] : samples()) {
    SCOPED_TRACE(name);
    const Bytes bytes = encoded(mesh);
    bool base = false;
    const std::size_t step = bytes.size() > 2000 ? 7 : 1;
    for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : step) {
      const bool now = decodes(prefix(bytes, size));
      EXPECT_TRUE(now || !base) << "longer than a prefix that decodes, but refused: " << size;
      base = base || now;
    }
    EXPECT_TRUE(base);
  }
}

TEST(Stream, MoreOfItIsNearer) {
  HybridMesh mesh = grid(3, 2);
  give_maps(mesh);
  mesh.refine_uniform(4);
  give_positions(mesh, 3);
  const Bytes bytes = encoded(mesh);
  const HybridMesh whole = decoded(bytes);
  const std::vector<Vec3> best = whole.final_mesh().points;
  double before = HUGE_VAL;
  for (std::size_t size = 100; size < bytes.size(); size = size * 5 / 4) {
    const std::vector<Vec3> points = decoded(prefix(bytes, size)).final_mesh().points;
    double sum = 0;
    for (std::size_t v = 0; v < points.size(); ++v) sum += (points[v] - best[v]).squaredNorm();
    const double error = std::sqrt(sum / static_cast<double>(points.size()));
    EXPECT_LE(error, 1.01 * before) << size;
    before = error;
  }
  EXPECT_LT(before, 1e-4 * diagonal(best));
}

TEST(Stream, BoundsAreKept) {
  HybridMesh mesh = grid(3, 2);
  give_maps(mesh);
  mesh.refine_uniform(4);
  give_positions(mesh, 3);
  const Bytes all = encoded(mesh), some = encoded(mesh, {300, 0});
  EXPECT_EQ(some, prefix(all, 300));
  const Bytes close = encoded(mesh, {0, 1e-3}), closer = encoded(mesh, {0, 1e-4});
  EXPECT_EQ(close, prefix(all, close.size()));
  EXPECT_LT(close.size(), closer.size());
  EXPECT_LT(closer.size(), all.size());
  EXPECT_THROW(encoded(mesh, {5, 0}), Error);
}

TEST(Stream, TheSameBytesEveryTime) {
  for (const auto& [name, mesh] : samples()) EXPECT_EQ(encoded(mesh), encoded(mesh)) << name;
}

TEST(Stream, BitFlipsDoNoHarm) {
  std::mt19937 random(5);
  for (const auto& [name, mesh] : samples()) {
    SCOPED_TRACE(name);
    const Bytes bytes = encoded(mesh);
    for (std::size_t bit = 0; bit < 8 * std::min<std::size_t>(bytes.size(), 60); bit += 3) {
      Bytes bad = prefix(bytes, std::min<std::size_t>(bytes.size(), 300));
      bad[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
      decodes(bad);
    }
    for (int i = 0; i < 20; ++i) {
      Bytes bad = prefix(bytes, std::min<std::size_t>(bytes.size(), 300));
      for (std::size_t k = 4 + random() % 40; k < bad.size(); ++k) bad[k] = static_cast<std::uint8_t>(random());
      decodes(bad);
    }
  }
}

ErrorCode refusal(const Bytes& bytes) {
  try {
    decoded(bytes);
  } catch (const Error& error) {
    return error.code();
  }
  ADD_FAILURE() << "decoded";
  return ErrorCode::Internal;
}

TEST(Stream, WhatIsNoStreamIsRefused) {
  EXPECT_EQ(refusal({}), ErrorCode::CorruptStream);
  EXPECT_EQ(refusal({'H', 'M', 'w'}), ErrorCode::CorruptStream);
  EXPECT_EQ(refusal({'H', 'M', 'w', 0, 1, 2, 3}), ErrorCode::CorruptStream);
  EXPECT_EQ(refusal({'H', 'M', 'w', 2, 1, 2, 3}), ErrorCode::Unsupported);
  EXPECT_EQ(refusal({'p', 'l', 'y', '\n', 1, 2, 3}), ErrorCode::CorruptStream);
  EXPECT_THROW(encoded(HybridMesh()), Error);
  HybridMesh off = grid(2, 2);
  off.refine_uniform(1);
  ASSERT_EQ(off.apply(cube_on(off, off.first_child(1))), "");
  ASSERT_EQ(off.set_enabled({false}), "");
  EXPECT_THROW(encoded(off), Error);
}

TEST(Stream, TreesThatAreNotBalancedAreRefused) {
  // Found by fuzzing: a quad with finer ones on three sides.
  const std::string found = std::string(35, 'V') + "64OFF\n1 0 0\n0 0 0 1\n";
  Bytes bytes = {'H', 'M', 'w', 1};
  bytes.insert(bytes.end(), found.begin(), found.end());
  EXPECT_EQ(refusal(bytes), ErrorCode::CorruptStream);
  HybridMesh mesh = grid(2, 1);
  mesh.refine_uniform(1);
  mesh.refine(mesh.first_child(0) + 1);
  mesh.refine(mesh.first_child(mesh.first_child(0) + 1) + 1);
  try {
    encoded(mesh);
    ADD_FAILURE() << "written";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
  }
}

// A stream of version 1: what was written once is read for ever. It is only replaced together with the version.
HybridMesh frozen_mesh() {
  HybridMesh mesh = grid(2, 1);
  mesh.set_sharp(0, 1);
  mesh.refine_uniform(1);
  EXPECT_EQ(mesh.apply(cube_on(mesh, mesh.first_child(1) + 2)), "");
  mesh.refine_balanced(mesh.first_child(0));
  mesh.balance();
  QuadMesh final = mesh.final_mesh();
  std::mt19937 random(7);
  for (Vec3& point : final.points)
    for (int i = 0; i < 3; ++i) point[i] = static_cast<double>(random() % 64) / 64;
  mesh.set_final_positions(final);
  return mesh;
}

const Bytes frozen = {
    0x48, 0x4d, 0x77, 0x01, 0xd4, 0xb9, 0x59, 0x61, 0x7a, 0x1d, 0x9a, 0xac, 0xde, 0x01, 0xfe, 0x56, 0x7c, 0x89, 0xc2, 0xe5, 0x0b, 0x9c, 0xe4, 0x81,
    0x7a, 0xf4, 0x1e, 0x18, 0xa5, 0x51, 0x02, 0x51, 0x36, 0x7e, 0xed, 0x2b, 0x08, 0x76, 0x5e, 0xb1, 0x4c, 0x8b, 0x1d, 0xc4, 0x7f, 0x97, 0x92, 0xae,
    0xf6, 0xf0, 0xa8, 0xfa, 0x76, 0x75, 0x8f, 0xb7, 0xb2, 0x9b, 0xd3, 0x17, 0xf1, 0x9c, 0xff, 0x5c, 0x7f, 0x15, 0x63, 0xe7, 0xdb, 0xbf, 0x8d, 0x97,
    0x66, 0xf5, 0xc1, 0x6f, 0xe1, 0x0c, 0x80, 0xb4, 0xaf, 0xcd, 0xd8, 0x0e, 0x14, 0x87, 0xf4, 0xb8, 0xbd, 0x72, 0xce, 0x81, 0x25, 0xc1, 0xa8, 0xf4,
    0x05, 0x36, 0xfa, 0xe2, 0x6a, 0x03, 0x7a, 0xbe, 0x33, 0xa9, 0xf4, 0x10, 0x52, 0xc4, 0x3b, 0x49, 0x4d, 0x36, 0x64, 0xa7, 0x80, 0x16, 0x02, 0x10,
    0x2a, 0x5d, 0xe7, 0x84, 0x09, 0xc7, 0x09, 0xa0, 0xb5, 0x6e, 0x61, 0x5b, 0x2c, 0xbb, 0xe6, 0x4b, 0x7f, 0x07, 0x29, 0x31, 0x2c, 0x61, 0x4d, 0x14,
    0xeb, 0x8d, 0xdf, 0xd6, 0x09, 0x02, 0x10, 0xb9, 0x4f, 0x1b, 0x16, 0xef, 0x58, 0xeb, 0x50, 0xf5, 0x01, 0xef, 0x2b, 0x81, 0xbc, 0x65, 0xa9, 0x95,
    0xbc, 0x89, 0xe9, 0xe6, 0x82, 0x85, 0x92, 0x1d, 0x73, 0xf7, 0xb6, 0xe5, 0x50, 0xa2, 0x76, 0xd1, 0xb8, 0x59, 0xe8, 0xfe, 0x62, 0x80, 0x4d, 0xf4,
    0x24, 0x5b, 0x67, 0x26, 0xbb, 0x47, 0x94, 0x4e, 0x7b, 0xe6, 0x7e, 0x51, 0x78, 0x5e, 0x65, 0xba, 0x8d, 0x7b, 0xac, 0x1a, 0xda, 0xbd, 0xbe, 0x0b,
    0xed, 0xd7, 0xe2, 0x63, 0x4a, 0x83, 0xde, 0x80, 0xc9, 0xb5, 0x5b, 0x7a, 0x85, 0xe4, 0xef, 0x10, 0xf7, 0xe0, 0x2b, 0x13, 0x3c, 0xf0, 0x18, 0xdc,
    0x1c, 0x28, 0x2d, 0xde, 0xd0, 0x67, 0x19, 0x72, 0xd5, 0x8d, 0xc8, 0x82, 0x69, 0x4b, 0xe2, 0xd5, 0x52, 0x3e, 0x7a, 0x81, 0x48, 0xb9, 0xe2, 0x15,
    0xd5, 0x9e, 0xc0, 0xef, 0xde, 0x10, 0x57, 0x61, 0xa6, 0xdd, 0x11, 0xd4, 0xd4, 0xe8, 0x1f, 0xc0, 0x17, 0x57, 0x29, 0xb1, 0x73, 0xb8, 0xfc, 0x99,
    0x55, 0x04, 0xb1, 0xa7, 0xf9, 0xa2, 0x86, 0x44, 0x77, 0x2c, 0xcb, 0x89, 0x40, 0xa3, 0x32, 0x58, 0xe8, 0x4d, 0x25, 0x4d, 0x47, 0xc0, 0xbb, 0x05,
    0xd3, 0x96, 0xd1, 0xfa, 0x79, 0xa5, 0x63, 0x11, 0xb0, 0x19, 0xe2, 0xc8, 0x6a, 0x4b, 0x89, 0x56, 0x3c, 0x4a, 0xcd, 0x3f, 0xcd, 0x91, 0xc1, 0x85,
    0xdb, 0x67, 0x24, 0xf4, 0x10, 0x2d, 0x1c, 0xda, 0xb5, 0x23, 0x28, 0xce, 0x3a, 0x23, 0x6f, 0xdd, 0x51, 0xdc, 0x75, 0x4d, 0xff, 0xd6, 0xac, 0xd7,
    0x53, 0xe2, 0x1a, 0xcf, 0xa0, 0xc9, 0xa8, 0x64, 0x73, 0xb5, 0x80, 0xe9, 0x0a, 0x48, 0xdd, 0x5f, 0xcf, 0x8c, 0x86, 0x8e, 0x77, 0x7b, 0xd4, 0x55,
    0x6c, 0xed, 0x28, 0x91, 0xb8, 0x4f, 0x5a, 0x27, 0xd7, 0xa1, 0x8a, 0x31, 0x1c, 0x1e, 0xe8, 0x93, 0xe7, 0x04, 0xcc, 0x04, 0xf2, 0xd2, 0x14, 0x39,
    0xe1, 0xb1, 0xf8, 0x38, 0x04, 0x02, 0xfb, 0xc0, 0xbb, 0xbb, 0x29, 0x8e, 0x1f, 0x2c, 0x6a, 0xc7, 0x44, 0xb2, 0x82, 0x3d, 0x17, 0x07, 0xf3, 0xab,
    0x66, 0xf2, 0x23, 0xb1, 0xc3, 0xee, 0xa3, 0xd8, 0xd8, 0x52, 0xab, 0xb1, 0xf1, 0x4a, 0xdb, 0x0e, 0xbf, 0x8b, 0x01, 0x0e, 0x31, 0x3c, 0xbb, 0x07,
    0x3d, 0x57, 0x24, 0xae, 0x35, 0xb4, 0x71, 0xdb, 0x96, 0x2a, 0xf6, 0x45, 0x37, 0xb6, 0x25, 0x13, 0x80, 0x76, 0xeb, 0x32, 0xb5, 0xf7, 0x17, 0x0d,
    0x5f, 0x86, 0x19, 0x6b, 0x3f, 0xcc, 0x25, 0xb8, 0x17, 0xce, 0xe9, 0x7d, 0x7d, 0x2c, 0x2c, 0xc0, 0x09, 0xf2, 0xb4, 0x8c, 0x6a, 0x55, 0xd2, 0x8d,
    0xad, 0x06, 0x3c, 0x78, 0x8a, 0x8b, 0xa8, 0x44, 0x3e, 0x1d, 0x8b, 0xf1, 0xf9, 0xf2, 0x00, 0x2a, 0x6a, 0xf1, 0xa9, 0x89, 0x42, 0x41, 0xa5, 0x25,
    0xbe, 0xdf, 0x57, 0x46, 0xfb, 0x17, 0xcc, 0x16, 0xcf, 0x06, 0x1d, 0x87, 0x80, 0xda, 0x2a, 0x14, 0xe2, 0x2c, 0x27, 0xff, 0xe3, 0xbf, 0x7f, 0x9b,
    0x7a, 0x83, 0x2f, 0xb9, 0xe1, 0x4a, 0x82, 0xf9, 0xae, 0xc2, 0x87, 0x16, 0xeb, 0x53, 0x1a, 0x3d, 0x40, 0xb4, 0xdc, 0xc6, 0x1a, 0x2a, 0x81, 0x5c,
    0x21, 0x29, 0x11, 0xbb, 0xb9, 0xe5, 0x38, 0xa7, 0xa0, 0x67, 0x19, 0x33, 0x4a, 0xad, 0x88, 0x48, 0x56, 0x14, 0x65, 0x82, 0x4b, 0x92, 0x55, 0x46,
    0x5f, 0x1d, 0x47, 0x24, 0xe5, 0x17, 0x7c, 0x41, 0x87, 0x98, 0x8e, 0x83, 0xb9, 0xb1, 0x50, 0x65, 0x92, 0xb1, 0x2e, 0x5b, 0xc5, 0x18, 0x76, 0x7f,
    0x1e, 0x9a, 0xe5, 0xbd, 0x67, 0x1b, 0x0d, 0x88, 0x72, 0x00, 0x67, 0x83, 0x1e, 0xec, 0xca, 0xc1, 0x8c, 0xba, 0xcc, 0xcd, 0xeb, 0x67, 0xc4, 0xd7,
    0x7d, 0xcc, 0x7c, 0x5d, 0x8c, 0x69, 0x98, 0x10, 0xe2, 0x20, 0x2c, 0x69, 0xaf, 0x1f, 0x61, 0xa5, 0xe6, 0xcb, 0xc0, 0xee, 0x04, 0x44, 0xf6, 0x09,
    0xd7, 0xa3, 0xe7, 0xf8, 0x89, 0xe2, 0xa8, 0x5f, 0xec, 0x98, 0xd7, 0x28, 0x1f, 0xbe, 0x66, 0x65, 0x89, 0x17, 0x52, 0xa0, 0xf8, 0x1a, 0x27, 0xf8,
    0xf3, 0xb9, 0x80, 0x00, 0xe5, 0x43, 0xe8, 0x83, 0xee, 0xc7, 0x05, 0x7c, 0xc2, 0x1c, 0xc0, 0x68, 0xeb, 0x3f, 0xfd, 0x7a, 0x45, 0xcd, 0x9b, 0x99,
    0xb5, 0x66, 0x5c, 0xcf, 0xbc, 0xe6, 0x2c, 0x47, 0x9b, 0xd7, 0x7e, 0x6a, 0x9b, 0x49, 0xc1, 0xc8, 0x5d, 0xab, 0x22, 0x97, 0x2c, 0xbc, 0x61, 0xbd,
    0x87, 0x98, 0xf7, 0x89, 0xc1, 0xd4, 0x64, 0x66, 0x2d, 0x22, 0xd3, 0x89, 0x8d, 0x15, 0xc1, 0xb1, 0xde, 0x67, 0xd2, 0xe1, 0x8a, 0x73, 0xf5, 0x06,
    0x6b, 0xc8, 0x78, 0xdd};

TEST(Stream, FrozenStreamsAreRead) {
  const QuadMesh expected = frozen_mesh().final_mesh();
  QuadMesh mesh = decoded(frozen).final_mesh();
  ASSERT_EQ(mesh.vertex_count(), expected.vertex_count());
  EXPECT_LT(snap(expected.points, mesh.points), 2e-6);
  EXPECT_EQ(faces_by_place(mesh, mesh.points), faces_by_place(expected, expected.points));
  EXPECT_EQ(decoded(prefix(frozen, 60)).final_mesh().vertex_count(), expected.vertex_count());
}

// Of all levels and the final mesh: the same numbers on every machine, with any compiler.
std::uint64_t fingerprint(const HybridMesh& mesh) {
  std::uint64_t hash = 1469598103934665603ull;
  const auto add = [&](const auto* numbers, std::size_t count) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(numbers);
    for (std::size_t i = 0; i < count * sizeof *numbers; ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
  };
  for (int j = 0; j <= mesh.depth() + 1; ++j) {
    const QuadMesh level = j <= mesh.depth() ? mesh.level_mesh(j) : mesh.final_mesh();
    for (const Vec3& point : level.points) add(point.data(), 3);
    add(level.offsets.data(), level.offsets.size());
    add(level.indices.data(), level.indices.size());
    add(level.vertex.data(), level.vertex.size());
    add(level.node.data(), level.node.size());
    add(level.sharp.data(), level.sharp.size());
  }
  return hash;
}

TEST(Stream, FrozenStreamsHaveTheSameBits) {
  EXPECT_EQ(fingerprint(decoded(frozen)), 0x71c821d80f7a2379u);
  EXPECT_EQ(fingerprint(decoded(prefix(frozen, 400))), 0xe4aa0b27293f1027u);
  EXPECT_EQ(fingerprint(decoded(prefix(frozen, 60))), 0xb8419b09606c5abdu);
}

// No memory is made for what so few bytes cannot tell of.
TEST(Stream, AFewBytesTellOfFewQuads) {
  BitWriter writer;
  for (int i = 0; i < 2; ++i) writer.code_raw(false);  // closure
  NumberModel depth, quads;
  depth.code(writer, 0);
  writer.code_raw(true);   // uniform
  writer.code_raw(false);  // no operations
  quads.code(writer, most_stream_quads - 1);
  Bytes bytes = {'H', 'M', 'w', 1};
  const Bytes body = writer.finish();
  bytes.insert(bytes.end(), body.begin(), body.end());
  bytes.resize(15);
  EXPECT_EQ(refusal(bytes), ErrorCode::CorruptStream);
}

TEST(RangeCoder, ReadsWhatWasWritten) {
  std::mt19937 random(1);
  std::vector<bool> bits;
  std::vector<std::uint32_t> ones;
  BitWriter writer;
  for (int i = 0; i < 20000; ++i) {
    ones.push_back(i % 3 == 0 ? 1 : i % 3 == 1 ? 65535 : 1 + random() % 65535);
    bits.push_back(random() % 65536 < ones.back());
    writer.code(bits.back(), ones.back());
  }
  const Bytes bytes = writer.finish();
  BitReader reader(bytes.data(), bytes.size());
  for (std::size_t i = 0; i < bits.size(); ++i) ASSERT_EQ(reader.code(false, ones[i]), bits[i]) << i;
  // A prefix gives a prefix.
  BitReader part(bytes.data(), bytes.size() / 2);
  std::size_t read = 0;
  try {
    for (; read < bits.size(); ++read) ASSERT_EQ(part.code(false, ones[read]), bits[read]);
  } catch (const StreamEnd&) {
  }
  EXPECT_GT(read, bits.size() / 3);
  EXPECT_LT(read, bits.size());
}

TEST(BitModels, NumbersAndSkewedBits) {
  std::mt19937 random(1);
  std::vector<std::int64_t> numbers;
  for (int i = 0; i < 2000; ++i) numbers.push_back((static_cast<std::int64_t>(random()) - (1ll << 31)) / 2 >> (random() % 30));
  BitWriter writer;
  NumberModel model;
  for (const std::int64_t n : numbers) model.code_signed(writer, n);
  const Bytes bytes = writer.finish();
  BitReader reader(bytes.data(), bytes.size());
  NumberModel again;
  for (const std::int64_t n : numbers) ASSERT_EQ(again.code_signed(reader, 0), n);
  // One bit in a hundred costs eight hundredths of a bit; a model and a mixer of two come near it.
  BitWriter skewed;
  BitModel a, b;
  Mixer mixer;
  for (int i = 0; i < 50000; ++i) mixer.code(skewed, random() % 100 == 0, std::array<BitModel*, 2>{&a, &b});
  EXPECT_LT(static_cast<double>(skewed.finish().size()), 1.1 * 50000 * 0.0808 / 8);
}

}  // namespace
}  // namespace hybrid_mesh
