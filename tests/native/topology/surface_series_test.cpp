// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/surface_series.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "closed_and_opened.h"
#include "models.h"

namespace hybrid_mesh {
namespace {

using namespace testing;

TEST(SurfaceSeries, WithNoEventsIsTheSurfaceItself) {
  const TriangleSurface s = repaired(ball(6, 0.5));
  const SurfaceSeries series = close_topology(s, {});
  EXPECT_EQ(series.closed.faces, s.faces);
  EXPECT_EQ(series.closed.points, s.points);
  EXPECT_EQ(open_topology(series, {}).surface.faces, s.faces);
}

TEST(SurfaceSeries, CutsOfATorusMakeABall) {
  const TriangleSurface s = repaired(torus(24, 12));
  const SurfaceSeries series = close_topology(s, cuts_of(s));
  expect_sound(series);
  const TopologySummary closed = summarize_topology(to_soup(series.closed));
  EXPECT_EQ(closed.genus, 0);
  EXPECT_EQ(closed.components, 1);
  // The two copies of a point of the cut lie at the same place, on either side.
  std::vector<int> copies(s.points.size(), 0);
  for (const int v : series.point_origin)
    if (v >= 0) ++copies[v];
  EXPECT_EQ(std::count(copies.begin(), copies.end(), 2), static_cast<long>(series.events[0].loops[0].size()));
  EXPECT_EQ(std::count(copies.begin(), copies.end(), 0), 0);
}

TEST(SurfaceSeries, OpensAnySetOfEvents) {
  TriangleSurface s = repaired(ball(10, 0.6));
  join_faces(s, face_towards(s, Vec3(1, 0.2, -0.2)), face_towards(s, Vec3(-0.4, 1, -0.3)), 4, 1.2);
  join_faces(s, face_towards(s, Vec3(-1, -0.5, -0.2)), face_towards(s, Vec3(0, -1, -0.5)), 4, 0.5);
  finish(s);
  std::vector<TopologyEvent> events = cuts_of(s);
  ASSERT_EQ(events.size(), 2u);
  events.push_back({EventKind::Boundary, {boundary_cycles(s)[0], {}}, 0, LoopKind::Handle});
  const SurfaceSeries series = close_topology(s, events);
  expect_sound(series);
  for (int set = 0; set < 8; ++set) {
    const std::vector<bool> open{(set & 1) != 0, (set & 2) != 0, (set & 4) != 0};
    const OpenedSurface opened = open_topology(series, open);
    const TopologySummary summary = summarize_topology(to_soup(opened.surface));
    EXPECT_EQ(summary.genus, (open[0] ? 1 : 0) + (open[1] ? 1 : 0));
    EXPECT_EQ(summary.boundary_loops, open[2] ? 1 : 0);
    EXPECT_EQ(summary.components, 1);
    expect_same_places(series, opened);
  }
}

TEST(SurfaceSeries, JoinsComponentsByATubeAndHidesItsDisks) {
  PolygonSoup soup = ball(8);
  add(soup, ball(6, 2, Vec3(2.6, 0.2, 0)));
  const TriangleSurface s = repaired(soup);
  // Around the points nearest to each other.
  const auto rim_around = [&](const Vec3& at, bool first) {
    int nearest = -1;
    for (int v = 0; v < static_cast<int>(s.points.size()); ++v)
      if ((s.points[v].x() < 1.4) == first && (nearest < 0 || (s.points[v] - at).norm() < (s.points[nearest] - at).norm())) nearest = v;
    std::vector<int> rim;
    int h = 0;
    while (s.from(h) != nearest) ++h;
    for (const int start = h;;) {
      rim.push_back(s.to(h));
      h = s.opposite[TriangleSurface::previous(h)];
      if (h == start) return rim;
    }
  };
  TopologyEvent tube{EventKind::Tube, {rim_around(Vec3(1.5, 0, 0), true), rim_around(Vec3(1.3, 0, 0), false)}, 0, LoopKind::Handle};
  for (const bool turned : {false, true}) {
    if (turned) std::reverse(tube.loops[0].begin(), tube.loops[0].end());
    const SurfaceSeries series = close_topology(s, {tube});
    expect_sound(series);
    const TopologySummary closed = summarize_topology(to_soup(series.closed));
    EXPECT_EQ(closed.components, 1);
    EXPECT_EQ(closed.genus, 0);
    EXPECT_EQ(closed.boundary_loops, 0);
    EXPECT_EQ(series.hidden[0][0].size(), tube.loops[0].size());
    EXPECT_EQ(std::count(series.point_origin.begin(), series.point_origin.end(), -1) + static_cast<long>(s.points.size()) - 2,
              static_cast<long>(series.closed.points.size()));
  }
}

TEST(SurfaceSeries, CapsABoundaryOfThreePoints) {
  TriangleSurface s = repaired(ball(5));
  s.faces.erase(s.faces.begin() + 17);
  s.source_face.erase(s.source_face.begin() + 17);
  connect_half_edges(s);
  TopologyEvent event{EventKind::Boundary, {boundary_cycles(s)[0], {}}, 0, LoopKind::Handle};
  ASSERT_EQ(event.loops[0].size(), 3u);
  for (int turned = 0; turned < 2; ++turned) {
    const SurfaceSeries series = close_topology(s, {event});
    expect_sound(series);
    EXPECT_EQ(series.closed.points.size(), s.points.size() + 1);
    EXPECT_EQ(summarize_topology(to_soup(series.closed)).boundary_loops, 0);
    std::reverse(event.loops[0].begin(), event.loops[0].end());
  }
}

TEST(SurfaceSeries, RefusesEventsThatMeetOrAreNone) {
  const TriangleSurface s = repaired(torus(20, 10));
  const std::vector<TopologyEvent> cut = cuts_of(s);
  EXPECT_EQ(code_of([&] { close_topology(s, {cut[0], cut[0]}); }), ErrorCode::InvalidInput);
  TopologyEvent bad = cut[0];
  bad.loops[0].erase(bad.loops[0].begin() + 1);
  EXPECT_EQ(code_of([&] { close_topology(s, {bad}); }), ErrorCode::InvalidInput);
  bad = cut[0];
  bad.loops[0][1] = 100000;
  EXPECT_EQ(code_of([&] { close_topology(s, {bad}); }), ErrorCode::InvalidInput);
  bad = cut[0];
  bad.kind = EventKind::Boundary;
  EXPECT_EQ(code_of([&] { close_topology(s, {bad}); }), ErrorCode::InvalidInput);
  bad = cut[0];
  bad.kind = EventKind::Tube;
  bad.loops[1] = bad.loops[0];
  EXPECT_EQ(code_of([&] { close_topology(s, {bad}); }), ErrorCode::InvalidInput);
  bad.loops[0].resize(2);
  EXPECT_EQ(code_of([&] { close_topology(s, {bad}); }), ErrorCode::InvalidInput);
  EXPECT_EQ(code_of([&] { open_topology(close_topology(s, cut), {}); }), ErrorCode::InvalidInput);
}

TEST(SurfaceSeries, ClosesRealModels) {
  const auto models = real_models();
  if (models.empty()) GTEST_SKIP() << no_models();
  for (const auto& path : models) {
    SCOPED_TRACE(path.filename().string());
    const TriangleSurface s = repaired(read_polygon_soup(path.string()));
    std::vector<TopologyEvent> events = cuts_of(s);
    for (const auto& loop : boundary_cycles(s)) events.push_back({EventKind::Boundary, {loop, {}}, 0, LoopKind::Handle});
    const SurfaceSeries series = close_topology(s, events);
    expect_sound(series);
    const TopologySummary closed = summarize_topology(to_soup(series.closed));
    EXPECT_EQ(closed.genus, 0);
    EXPECT_EQ(closed.boundary_loops, 0);
    EXPECT_EQ(closed.components, summarize_topology(to_soup(s)).components);
  }
}

}  // namespace
}  // namespace hybrid_mesh
