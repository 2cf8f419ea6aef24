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

#include "base/error.h"
#include "codec/base_points.h"
#include "codec/bit_models.h"
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
  for (int q = 0; q < mesh.base_count(); ++q)
    mesh.set_map(q, make_map(2, 0, 1, [&](double u, double v) { return Vec3(q % 3 + u, q / 3 + v, 0.4 * std::sin(2 * u + q) * std::cos(v)); }));
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
  for (int i = 0; i < 50000; ++i) mixer.code(skewed, random() % 100 == 0, {&a, &b}, 2);
  EXPECT_LT(static_cast<double>(skewed.finish().size()), 1.1 * 50000 * 0.0808 / 8);
}

}  // namespace
}  // namespace hybrid_mesh
