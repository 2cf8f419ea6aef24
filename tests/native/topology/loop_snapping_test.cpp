// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "closed_and_opened.h"
#include "models.h"

namespace hybrid_mesh {
namespace {

using namespace testing;

Found<std::vector<int>> snapped(const TriangleSurface& s, const std::vector<Vec3>& stroke, SnapTightening tightening = SnapTightening::None) {
  Context context;
  return snap_loop(s, stroke, tightening, Progress(context));
}

// Around the tube of a torus, at an angle, through places that are off the surface and off its points.
std::vector<Vec3> around_tube(double at, double radius, int count, double slope = 0) {
  std::vector<Vec3> stroke;
  for (int i = 0; i < count; ++i) {
    const double b = 2 * std::numbers::pi * i / count, a = at + slope * std::sin(b);
    stroke.push_back(Vec3((1 + radius * std::cos(b)) * std::cos(a), (1 + radius * std::cos(b)) * std::sin(a), radius * std::sin(b)));
  }
  return stroke;
}

void expect_cycle(const TriangleSurface& s, const std::vector<int>& loop) {
  EXPECT_EQ(std::set<int>(loop.begin(), loop.end()).size(), loop.size());
  const auto cut = loops_of(s, {loop});  // throws if it is no cycle of edges or separates
  EXPECT_EQ(cut[0].points, loop);
}

TEST(LoopSnapping, FollowsAStroke) {
  const TriangleSurface s = repaired(torus(60, 30, 0.4, 0));
  for (const int count : {5, 30, 200}) {
    const auto loop = snapped(s, around_tube(0.71, 0.43, count, 0.2));
    ASSERT_TRUE(loop) << loop.reason;
    expect_cycle(s, *loop);
    for (const int v : *loop) {
      // Within an edge or two of the stroke.
      double nearest = 1e9;
      for (const Vec3& p : around_tube(0.71, 0.4, 400, 0.2)) nearest = std::min(nearest, (p - s.points[v]).norm());
      EXPECT_LT(nearest, count == 5 ? 0.4 : 0.2);
    }
  }
}

TEST(LoopSnapping, Tightens) {
  const TriangleSurface s = repaired(torus(60, 30, 0.4, 0));
  const auto loop = snapped(s, around_tube(0.71, 0.43, 40, 0.6), SnapTightening::Shortest);
  ASSERT_TRUE(loop);
  expect_cycle(s, *loop);
  EXPECT_NEAR(cycle_length(s, *loop), 60 * 0.4 * std::sin(std::numbers::pi / 30), 1e-6);
}

TEST(LoopSnapping, StaysTheLoopItIs) {
  const TriangleSurface s = repaired(plate_with_windows(3, 4));
  for (const SurfaceLoop& loop : loops_of(s)) {
    std::vector<Vec3> stroke;
    for (const int v : loop.points) stroke.push_back(s.points[v]);
    const auto same = snapped(s, stroke);
    ASSERT_TRUE(same);
    EXPECT_EQ(*same, loop.points);
  }
}

TEST(LoopSnapping, LeavesOutWhatCrosses) {
  const TriangleSurface s = repaired(torus(60, 30, 0.4, 0));
  // Once around the tube, and then a round trip aside.
  std::vector<Vec3> stroke = around_tube(0.7, 0.4, 60);
  for (int i = 0; i < 20; ++i) {
    const double t = 2 * std::numbers::pi * i / 20, a = 0.7 + 0.3 * (1 - std::cos(t)), b = 0.3 * std::sin(t);
    stroke.push_back(Vec3((1 + 0.4 * std::cos(b)) * std::cos(a), (1 + 0.4 * std::cos(b)) * std::sin(a), 0.4 * std::sin(b)));
  }
  const auto loop = snapped(s, stroke);
  ASSERT_TRUE(loop);
  expect_cycle(s, *loop);
  EXPECT_LT(loop->size(), 60u);
}

TEST(LoopSnapping, KeepsOffBoundaries) {
  TriangleSurface s = repaired(torus(60, 30, 0.4, 0));
  std::vector<std::array<int, 3>> kept;
  for (std::size_t f = 0; f < s.faces.size(); ++f)
    if (f % 97 != 5) kept.push_back(s.faces[f]);
  s.faces = kept;
  finish(s);
  for (int k = 0; k < 10; ++k) {
    const auto loop = snapped(s, around_tube(0.1 * k, 0.4, 60));
    if (loop) expect_cycle(s, *loop);
  }
}

TEST(LoopSnapping, SaysWhereItCannot) {
  PolygonSoup soup = ball(8);
  add(soup, ball(8, 2, Vec3(4, 0, 0)));
  const TriangleSurface s = repaired(soup);
  const auto none = snapped(s, {Vec3(0, 1, 0), Vec3(4, 1, 0), Vec3(4, -1, 0), Vec3(0, -1, 0)});
  EXPECT_FALSE(none);
  EXPECT_NE(none.reason.find("leaves the surface"), std::string::npos);
  EXPECT_FALSE(snapped(s, {Vec3(1, 0, 0), Vec3(1, 0.001, 0), Vec3(1, 0, 0.001)}));
  EXPECT_EQ(code_of([&] { snapped(s, {Vec3(1, 0, 0)}); }), ErrorCode::InvalidInput);
  EXPECT_EQ(code_of([&] { snapped(s, {Vec3(1, 0, 0), Vec3(0, NAN, 0)}); }), ErrorCode::InvalidInput);
}

// A loop of a version with fewer points is found again on one with more.
TEST(LoopSnapping, CarriesLoopsToAnotherResolution) {
  const auto coarse_path = models_folder() / "buddha_10k.ply", fine_path = models_folder() / "buddha.ply";
  if (!std::filesystem::exists(coarse_path) || !std::filesystem::exists(fine_path)) GTEST_SKIP() << no_models();
  const TriangleSurface coarse = repaired(read_polygon_soup(coarse_path.string())), fine = repaired(read_polygon_soup(fine_path.string()));
  std::vector<std::vector<int>> carried;
  const auto loops = loops_of(coarse);
  const auto size = [](const TriangleSurface& s) {
    Vec3 low = s.points[0], high = low;
    for (const Vec3& p : s.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return std::pair(low, (high - low).norm());
  };
  const auto [from, from_size] = size(coarse);
  const auto [to, to_size] = size(fine);
  for (const SurfaceLoop& loop : loops) {
    std::vector<Vec3> stroke;
    for (const int v : loop.points) stroke.push_back(to + (coarse.points[v] - from) * (to_size / from_size));
    const auto snapped_loop = snapped(fine, stroke, SnapTightening::Shortest);
    ASSERT_TRUE(snapped_loop) << snapped_loop.reason;
    carried.push_back(*snapped_loop);
    EXPECT_LT(cycle_length(fine, carried.back()) / to_size, 1.15 * loop.length / from_size);
  }
  EXPECT_EQ(loops_of(fine, carried).size(), loops.size());
}

}  // namespace
}  // namespace hybrid_mesh
