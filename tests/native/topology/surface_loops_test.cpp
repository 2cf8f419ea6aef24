// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/surface_loops.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <set>
#include <string>

#include "closed_and_opened.h"
#include "models.h"

namespace hybrid_mesh {
namespace {

using namespace testing;

// As many loops as the genus, disjoint cycles along edges, and genus 0 once the surface is cut along them.
void expect_loops(const TriangleSurface& s, const std::vector<SurfaceLoop>& loops) {
  const TopologySummary summary = summarize_topology(to_soup(s));
  EXPECT_EQ(static_cast<double>(loops.size()), summary.genus);
  std::set<int> used;
  for (const SurfaceLoop& loop : loops) {
    EXPECT_GT(loop.length, 0);
    for (const int v : loop.points) EXPECT_TRUE(used.insert(v).second);
  }
  const SurfaceSeries series = close_topology(s, cuts_of(loops));
  expect_sound(series);
  const TopologySummary closed = summarize_topology(to_soup(series.closed));
  EXPECT_EQ(closed.genus, 0);
  EXPECT_EQ(closed.components, summary.components);
  EXPECT_EQ(closed.boundary_loops, summary.boundary_loops);
}

std::vector<int> meridian(int i, int m) {
  std::vector<int> loop;
  for (int j = 0; j < m; ++j) loop.push_back(i * m + j);
  return loop;
}

TEST(SurfaceLoops, ABallHasNone) {
  EXPECT_TRUE(loops_of(repaired(ball(5))).empty());
  EXPECT_TRUE(loops_of(repaired(ball(5, 0.3))).empty());
}

TEST(SurfaceLoops, OfATorusIsAsShortAsItsTube) {
  const TriangleSurface s = repaired(torus(48, 24, 0.3, 0));
  const auto loops = loops_of(s);
  expect_loops(s, loops);
  // Around the tube, which is shortest anywhere: 24 chords.
  EXPECT_NEAR(loops[0].length, 2 * 24 * 0.3 * std::sin(std::numbers::pi / 24), 1e-9);
  EXPECT_EQ(loops[0].kind, LoopKind::Handle);
  // The same turned inside out.
  TriangleSurface turned = s;
  for (auto& face : turned.faces) std::swap(face[1], face[2]);
  connect_half_edges(turned);
  EXPECT_EQ(loops_of(turned)[0].kind, LoopKind::Handle);
}

TEST(SurfaceLoops, OfAFatTorusGoesThroughItsHole) {
  const TriangleSurface s = repaired(torus(48, 48, 0.8, 0));
  const auto loops = loops_of(s);
  expect_loops(s, loops);
  EXPECT_LT(loops[0].length, 2 * std::numbers::pi * 0.2 * 1.02);
  EXPECT_EQ(loops[0].kind, LoopKind::Tunnel);
}

TEST(SurfaceLoops, OfChainsOfHandles) {
  for (const int genus : {2, 5, 50}) {
    SCOPED_TRACE(genus);
    const TriangleSurface s = repaired(plate_with_windows(genus, genus > 10 ? 3 : 4));
    expect_loops(s, loops_of(s));
  }
}

TEST(SurfaceLoops, OfLinkedTori) {
  PolygonSoup soup = torus(30, 16, 0.3);
  PolygonSoup other = torus(30, 16, 0.3);
  for (Vec3& p : other.points) p = Vec3(p.x() + 1, p.z(), p.y());
  for (std::size_t i = 0; i < other.indices.size(); i += 4) std::swap(other.indices[i + 1], other.indices[i + 3]);
  add(soup, other);
  const TriangleSurface s = repaired(soup);
  const auto loops = loops_of(s);
  expect_loops(s, loops);
  // The other torus winds nowhere inside this one.
  for (const SurfaceLoop& loop : loops) EXPECT_EQ(loop.kind, LoopKind::Handle);
}

TEST(SurfaceLoops, OfNestedToriJoinedByATube) {
  PolygonSoup soup = torus(40, 24, 0.4);
  PolygonSoup inner = torus(40, 16, 0.2);
  for (std::size_t i = 0; i < inner.indices.size(); i += 4) std::swap(inner.indices[i + 1], inner.indices[i + 3]);
  add(soup, inner);
  TriangleSurface s = repaired(soup);
  join_faces(s, face_towards(s, Vec3(1, 0, 0.3)), static_cast<int>(s.faces.size()) - 7, 3, 0);
  finish(s);
  ASSERT_EQ(summarize_topology(to_soup(s)).genus, 2);
  expect_loops(s, loops_of(s));
}

TEST(SurfaceLoops, OfATubeInsideATube) {
  // A pipe with a wall: its bore is a tunnel, and a bridge across the bore makes another.
  PolygonSoup soup = torus(40, 20, 0.5);
  TriangleSurface s = repaired(soup);
  const int one = face_towards(s, Vec3(1, 0, 0.2)), two = face_towards(s, Vec3(-1, 0.1, 0.2));
  join_faces(s, one, two, 6, 0.3);
  finish(s);
  expect_loops(s, loops_of(s));
}

TEST(SurfaceLoops, OfHandlesOfThreeEdgesAround) {
  TriangleSurface s = repaired(ball(12));
  const int long_from = face_towards(s, Vec3(1, 0.3, 0.2)), long_to = face_towards(s, Vec3(0.2, 1, -0.1));
  const int short_from = face_towards(s, Vec3(-1, 0.3, 0.2)), short_to = face_towards(s, Vec3(-0.2, -1, -0.1));
  join_faces(s, long_from, long_to, 5, 1);
  join_faces(s, short_from, short_to, 1, 0);
  finish(s);
  const auto loops = loops_of(s);
  expect_loops(s, loops);
  for (const SurfaceLoop& loop : loops) EXPECT_EQ(loop.points.size(), 3u);
}

TEST(SurfaceLoops, OfTwoHandlesThroughOneRing) {
  TriangleSurface s = repaired(ball(16));
  std::vector<std::array<int, 2>> faces;
  for (const auto& [x, y] : {std::pair(1.0, 0.0), std::pair(0.1, 0.7), std::pair(-0.2, 0.8)})
    faces.push_back({face_towards(s, Vec3(x, y, 1)), face_towards(s, Vec3(y == 0 ? -x : x, -y, 1))});
  for (std::size_t i = 0; i < faces.size(); ++i) join_faces(s, faces[i][0], faces[i][1], 8, i == 0 ? 1.5 : 0.2 + 0.1 * i);
  finish(s);
  expect_loops(s, loops_of(s));
}

TEST(SurfaceLoops, OfManyComponents) {
  PolygonSoup soup;
  for (int i = 0; i < 200; ++i) {
    PolygonSoup one = i % 10 ? ball(3) : torus(8, 5);
    const int column = i % 15, row = i / 15;
    for (Vec3& p : one.points) p += Vec3(4 * column, 4 * row, 0);
    add(soup, one);
  }
  const TriangleSurface s = repaired(soup);
  const auto loops = loops_of(s);
  EXPECT_EQ(loops.size(), 20u);
  expect_loops(s, loops);
}

TEST(SurfaceLoops, OfNoise) {
  const TriangleSurface s = noisy_ball(40, 300);
  ASSERT_EQ(summarize_topology(to_soup(s)).genus, 300);
  expect_loops(s, loops_of(s));
}

TEST(SurfaceLoops, KeepAwayFromBoundaries) {
  TriangleSurface s = repaired(torus(40, 20));
  // Holes all over, which leave a way between them.
  std::vector<std::array<int, 3>> kept;
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    if (f % 160 != 0) kept.push_back(s.faces[f]);
  s.faces = kept;
  finish(s);
  const auto loops = loops_of(s);
  expect_loops(s, loops);
  for (const auto& hole : boundary_cycles(s))
    for (const int v : hole)
      for (const SurfaceLoop& loop : loops) EXPECT_EQ(std::count(loop.points.begin(), loop.points.end(), v), 0);
}

TEST(SurfaceLoops, ATorusOfFewTriangles) {
  const TriangleSurface s = repaired(torus(3, 3));
  expect_loops(s, loops_of(s));
}

// Random surfaces of few triangles: there are enough disjoint loops, or it is said that there are not.
TEST(SurfaceLoops, WhereThereIsLittleRoom) {
  int found = 0, none = 0;
  for (int seed = 0; seed < 60; ++seed) {
    TriangleSurface s = repaired(ball(2 + seed % 3));
    std::uint64_t state = seed * 7919 + 1;
    for (int tries = 0, made = 0; tries < 60 && made < 1 + seed % 5; ++tries) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      const int f = static_cast<int>((state >> 33) % s.faces.size());
      state = state * 6364136223846793005u + 1442695040888963407u;
      const int g = static_cast<int>((state >> 33) % s.faces.size());
      TriangleSurface next = s;
      if (f == g) continue;
      join_faces(next, f, g, 1, 0);
      try {
        finish(next);
      } catch (const Error&) {
        continue;  // the faces were too near each other
      }
      if (summarize_topology(to_soup(next)).nonmanifold_vertices > 0) continue;
      s = next;
      ++made;
    }
    finish(s);
    try {
      expect_loops(s, loops_of(s));
      ++found;
    } catch (const NoMap&) {
      ++none;
    }
  }
  EXPECT_GT(found, 5 * none);
}

TEST(SurfaceLoops, GivenOnesAreKept) {
  const TriangleSurface s = repaired(plate_with_windows(2, 4));
  // Not the shortest: what is found with the first one's neighbourhood taken.
  const auto own = loops_of(s);
  const TriangleSurface t = repaired(torus(30, 12));
  const auto loops = loops_of(t, {meridian(5, 12)});
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].points, meridian(5, 12));
  const auto again = loops_of(s, {own[1].points});
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again[0].points, own[1].points);
  expect_loops(s, again);
}

std::string complaint(const TriangleSurface& s, const std::vector<std::vector<int>>& given) {
  try {
    loops_of(s, given);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

TEST(SurfaceLoops, RefuseWhatIsGiven) {
  const TriangleSurface s = repaired(torus(30, 12));
  const auto says = [&](const std::vector<std::vector<int>>& given, const std::string& words) {
    EXPECT_NE(complaint(s, given).find(words), std::string::npos) << complaint(s, given);
  };
  says({meridian(5, 12), meridian(5, 12)}, "loop 1 touches");
  says({meridian(5, 12), meridian(9, 12)}, "loop 1 separates");
  says({{0, 1}}, "loop 0 has fewer");
  says({{0, 1, 1000000}}, "does not exist");
  says({{-1, 1, 2}}, "does not exist");
  says({{0, 1, 7 * 12}}, "no edge");
  says({{s.faces[0][0], s.faces[0][1], s.faces[0][2]}}, "loop 0 separates");
  std::vector<int> twice = meridian(5, 12);
  twice.insert(twice.end(), twice.begin(), twice.end());
  says({twice}, "twice");
  says({{0, 0, 0}}, "twice");
}

TEST(SurfaceLoops, LeaveOutWhatHasNoName) {
  const TriangleSurface s = repaired(torus(30, 12));
  Context context;
  const std::vector<GivenLoop> given{{{0, 1}, ""}, {meridian(5, 12), "the drawn one"}, {meridian(9, 12), ""}};
  const auto loops = find_loops(s, given, {}, Progress(context));
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].points, meridian(5, 12));
  EXPECT_EQ(loops[0].given, 1);
  // Where only one without a name is in the way of another, what is missing is looked for.
  const auto found = find_loops(s, {{{0, 1, 1000000}, ""}}, {}, Progress(context));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].given, -1);
}

TEST(SurfaceLoops, AreTheSameForAnyNumberOfThreads) {
  const TriangleSurface s = repaired(plate_with_windows(6, 5));
  std::vector<std::vector<SurfaceLoop>> found;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    found.push_back(loops_of(s));
  }
  for (const auto& loops : found) {
    ASSERT_EQ(loops.size(), found[0].size());
    for (std::size_t i = 0; i < loops.size(); ++i) {
      EXPECT_EQ(loops[i].points, found[0][i].points);
      EXPECT_EQ(loops[i].length, found[0][i].length);
    }
  }
}

TEST(SurfaceLoops, CanBeCancelled) {
  const TriangleSurface s = repaired(plate_with_windows(4, 5));
  Context context;
  context.cancel();
  EXPECT_EQ(code_of([&] { find_loops(s, {}, {}, Progress(context)); }), ErrorCode::Cancelled);
}

TEST(SurfaceLoops, LongOnesAreLeftOut) {
  const TriangleSurface s = repaired(plate_with_windows(3, 4));
  const auto all = loops_of(s);
  LoopOptions options;
  options.longest = (all[0].length + all[2].length) / 2;
  const auto some = loops_of(s, {}, options);
  EXPECT_LT(some.size(), all.size());
  for (const SurfaceLoop& loop : some) EXPECT_LE(loop.length, options.longest);
  options.longest = 1e-6;
  EXPECT_TRUE(loops_of(s, {}, options).empty());
}

// Sums of lengths by the diagonal of the bounding box, 1.02 times what is known to be possible.
TEST(SurfaceLoops, OfRealModelsAreShort) {
  if (real_models().empty()) GTEST_SKIP() << no_models();
  const std::vector<std::pair<std::string, double>> known{{"eight", .789},  {"elephant", .268},   {"rocker_arm", .622}, {"fertility", .745},
                                                          {"feline", .179}, {"buddha_10k", .850}, {"buddha", .884}};
  for (const auto& [name, sum] : known) {
    const auto path = models_folder() / (name + ".ply");
    if (!std::filesystem::exists(path)) continue;
    SCOPED_TRACE(name);
    const TriangleSurface s = repaired(read_polygon_soup(path.string()));
    const auto loops = loops_of(s);
    Vec3 low = s.points[0], high = low;
    for (const Vec3& p : s.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    double length = 0;
    for (const SurfaceLoop& loop : loops) length += loop.length;
    EXPECT_LT(length / (high - low).norm(), 1.02 * sum);
  }
}

}  // namespace
}  // namespace hybrid_mesh
