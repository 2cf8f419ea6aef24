// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/loop_search.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "closed_and_opened.h"

namespace hybrid_mesh {
namespace {

using namespace testing;

std::vector<RequestedLoop> search(const TriangleSurface& s, const LoopRequest& request) {
  Context context;
  return search_loops(s, request, Progress(context));
}

std::vector<Vec3> places(const TriangleSurface& s, const std::vector<int>& loop) {
  std::vector<Vec3> at;
  for (const int v : loop) at.push_back(s.points[v]);
  return at;
}

std::vector<Vec3> moved(std::vector<Vec3> line, const Vec3& by) {
  for (Vec3& p : line) p += by;
  return line;
}

// What a loop of the request's list became, in the order of the result: its source, and whether it is drawn.
using Origin = std::pair<int, bool>;
std::vector<Origin> origins(const std::vector<RequestedLoop>& loops) {
  std::vector<Origin> out;
  for (const RequestedLoop& loop : loops) out.push_back({loop.source, loop.drawn});
  return out;
}

std::string complaint(const TriangleSurface& s, const LoopRequest& request) {
  try {
    search(s, request);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(LoopSearch, KeepsWhatIsThere) {
  const TriangleSurface s = repaired(plate_with_windows(3, 4));
  const auto own = loops_of(s);
  ASSERT_GE(own.size(), 3u);
  LoopRequest request;
  for (const SurfaceLoop& loop : own) request.loops.push_back({places(s, loop.points), false});
  request.loops[1].drawn = true;
  const auto again = search(s, request);
  ASSERT_EQ(again.size(), own.size());
  EXPECT_EQ(again[0].source, 1);  // what is drawn comes first
  for (const RequestedLoop& loop : again) {
    ASSERT_GE(loop.source, 0);
    EXPECT_EQ(loop.loop.points, own[loop.source].points);
    EXPECT_EQ(loop.loop.kind, own[loop.source].kind);
    EXPECT_EQ(loop.drawn, loop.source == 1);
  }
}

TEST(LoopSearch, FindsWhatIsMissing) {
  const TriangleSurface s = repaired(plate_with_windows(2, 4));
  const auto own = loops_of(s);
  LoopRequest request;
  request.loops = {{places(s, own.back().points), true}};
  const auto loops = search(s, request);
  ASSERT_EQ(loops.size(), own.size());
  EXPECT_EQ(loops[0].loop.points, own.back().points);
  EXPECT_EQ(std::count_if(loops.begin(), loops.end(), [](const RequestedLoop& loop) { return loop.source < 0; }),
            static_cast<std::ptrdiff_t>(own.size()) - 1);
  request.options.longest = 0;
  EXPECT_EQ(origins(search(s, request)), (std::vector<Origin>{{0, true}}));
  request.loops.clear();
  EXPECT_TRUE(search(s, request).empty());
}

TEST(LoopSearch, SnapsWhatIsNoCycleOfTheSurfaceAnyMore) {
  const TriangleSurface coarse = repaired(torus(30, 12)), fine = repaired(torus(75, 31));
  const auto line = places(coarse, loops_of(coarse)[0].points);
  for (const bool drawn : {false, true}) {
    const auto loops = search(fine, {{{line, drawn}}, {}, {}});
    EXPECT_EQ(origins(loops), (std::vector<Origin>{{0, drawn}}));
  }
}

TEST(LoopSearch, WhatIsFoundGivesWayToWhatIsDrawn) {
  const TriangleSurface s = repaired(torus(30, 12));
  const auto line = places(s, loops_of(s)[0].points);
  const std::vector<Vec3> gone = moved(line, Vec3(0, 0, 50)), leaving{Vec3(1.4, 0, 0), Vec3(50, 0, 0), Vec3(50, 1, 0)};
  // A loop of its list goes where it is in the way of a drawn one or of a stroke, or is on the surface no more.
  EXPECT_EQ(origins(search(s, {{{line, false}, {line, true}}, {}, {}})), (std::vector<Origin>{{1, true}}));
  EXPECT_EQ(origins(search(s, {{{line, false}}, {line}, {}})), (std::vector<Origin>{{-1, true}}));
  EXPECT_EQ(origins(search(s, {{{leaving, false}, {line, false}}, {}, {}})), (std::vector<Origin>{{1, false}}));
  // What is drawn never goes without a word.
  EXPECT_NE(complaint(s, {{{leaving, true}}, {}, {}}).find("loop 1 is not on the surface"), std::string::npos);
  EXPECT_NE(complaint(s, {{}, {leaving}, {}}).find("stroke 1: "), std::string::npos);
  EXPECT_NE(complaint(s, {{{gone, false}, {line, true}}, {line}, {}}).find("stroke 1 "), std::string::npos);
  EXPECT_NE(complaint(s, {{{line, false}, {line, true}, {line, true}}, {}, {}}).find("loop 3 "), std::string::npos);
  EXPECT_NE(complaint(s, {{}, {line, line}, {}}).find("stroke 2 "), std::string::npos);
}

TEST(LoopSearch, TightensStrokesAndNothingElse) {
  const TriangleSurface s = repaired(torus(60, 30, 0.4, 0));
  std::vector<Vec3> slanted;
  for (int i = 0; i < 40; ++i) {
    const double b = 2 * std::numbers::pi * i / 40, a = 0.7 + 0.6 * std::sin(b);
    slanted.push_back(Vec3((1 + 0.42 * std::cos(b)) * std::cos(a), (1 + 0.42 * std::cos(b)) * std::sin(a), 0.42 * std::sin(b)));
  }
  const auto stroke = search(s, {{}, {slanted}, {}}), earlier = search(s, {{{slanted, true}}, {}, {}});
  ASSERT_EQ(stroke.size(), 1u);
  ASSERT_EQ(earlier.size(), 1u);
  EXPECT_LT(stroke[0].loop.length, 0.95 * earlier[0].loop.length);
}

}  // namespace
}  // namespace hybrid_mesh
