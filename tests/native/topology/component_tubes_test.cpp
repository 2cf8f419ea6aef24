// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/component_tubes.h"

#include <gtest/gtest.h>

#include "closed_and_opened.h"
#include "models.h"
#include "surface/closest_point.h"
#include "surface/triangle_intersection.h"
#include "topology/topological_noise.h"

namespace hybrid_mesh {
namespace {

using namespace testing;

std::vector<TopologyEvent> tubes_of(const TriangleSurface& s, const std::vector<TopologyEvent>& others = {}) {
  Context context;
  return find_tubes(s, others, Progress(context));
}

// Pairs of faces of a closed surface, one of an event, that meet where they share nothing.
int hits_of_patches(const SurfaceSeries& series) {
  const TriangleSurface& s = series.closed;
  const SurfaceDistanceQuery query(s);
  int hits = 0;
  std::vector<int> near;
  for (std::size_t f = 0; f < s.faces.size(); ++f) {
    if (series.face_event[f] < 0) continue;
    const std::array<const Vec3*, 3> t{&s.points[s.faces[f][0]], &s.points[s.faces[f][1]], &s.points[s.faces[f][2]]};
    query.faces_in_box(t[0]->cwiseMin(*t[1]).cwiseMin(*t[2]), t[0]->cwiseMax(*t[1]).cwiseMax(*t[2]), s.faces.size(), near);
    for (const int g : near)
      if (series.face_event[g] != series.face_event[f])
        hits += triangles_meet(t, {&s.points[s.faces[g][0]], &s.points[s.faces[g][1]], &s.points[s.faces[g][2]]});
  }
  return hits;
}

TEST(ComponentTubes, OneComponentNeedsNone) { EXPECT_TRUE(tubes_of(repaired(ball(5))).empty()); }

TEST(ComponentTubes, JoinManyComponents) {
  PolygonSoup soup;
  constexpr int count = 200;
  for (int i = 0; i < count; ++i) {
    const int row = i / 15;
    add(soup, ball(3, 2, Vec3(2.3 * (i % 15), 2.4 * row, 0.1 * (i % 7))));
  }
  const TriangleSurface s = repaired(soup);
  const auto tubes = tubes_of(s);
  EXPECT_EQ(tubes.size(), count - 1u);
  const SurfaceSeries series = close_topology(s, tubes);
  expect_sound(series);
  const TopologySummary closed = summarize_topology(to_soup(series.closed));
  EXPECT_EQ(closed.components, 1);
  EXPECT_EQ(closed.genus, 0);
  EXPECT_EQ(hits_of_patches(series), 0);
}

TEST(ComponentTubes, JoinComponentsThatInterpenetrate) {
  PolygonSoup soup = ball(10);
  add(soup, ball(10, 2, Vec3(1.2, 0.3, 0)));
  const TriangleSurface s = repaired(soup);
  const auto tubes = tubes_of(s);
  ASSERT_EQ(tubes.size(), 1u);
  const SurfaceSeries series = close_topology(s, tubes);
  expect_sound(series);
  EXPECT_EQ(summarize_topology(to_soup(series.closed)).components, 1);
  EXPECT_EQ(hits_of_patches(series), 0);
}

TEST(ComponentTubes, KeepOffOtherEvents) {
  PolygonSoup soup = torus(24, 12);
  add(soup, ball(6, 0.4, Vec3(2.7, 0, 0)));
  const TriangleSurface s = repaired(soup);
  std::vector<TopologyEvent> events = cuts_of(s), holes = find_boundary_events(s);
  EXPECT_EQ(holes.size(), 1u);
  events.insert(events.end(), holes.begin(), holes.end());
  const auto tubes = tubes_of(s, events);
  EXPECT_EQ(tubes.size(), 1u);
  events.insert(events.end(), tubes.begin(), tubes.end());
  const SurfaceSeries series = close_topology(s, events);
  expect_sound(series);
  const TopologySummary closed = summarize_topology(to_soup(series.closed));
  EXPECT_EQ(closed.components, 1);
  EXPECT_EQ(closed.genus, 0);
  EXPECT_EQ(closed.boundary_loops, 0);
}

TEST(ComponentTubes, LeaveAloneWhatHasNoRoom) {
  PolygonSoup soup = ball(4);
  // A triangle by itself: all its points are at its boundary.
  PolygonSoup one;
  one.points = {Vec3(3, 0, 0), Vec3(3, 1, 0), Vec3(3, 0, 1)};
  one.indices = {0, 1, 2};
  one.offsets = {0, 3};
  add(soup, one);
  EXPECT_TRUE(tubes_of(repaired(soup)).empty());
}

TEST(ComponentTubes, JoinTetrahedra) {
  PolygonSoup soup;
  for (int i = 0; i < 3; ++i) {
    PolygonSoup one;
    one.points = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    for (Vec3& p : one.points) p.x() += 2 * i;
    one.indices = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    one.offsets = {0, 3, 6, 9, 12};
    add(soup, one);
  }
  const TriangleSurface s = repaired(soup);
  const auto tubes = tubes_of(s);
  const SurfaceSeries series = close_topology(s, tubes);
  expect_sound(series);
  EXPECT_EQ(summarize_topology(to_soup(series.closed)).genus, 0);
}

TEST(ComponentTubes, JoinBones) {
  const auto path = models_folder() / "foot_bones.ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << no_models();
  const TriangleSurface s = repaired(read_polygon_soup(path.string()));
  const auto tubes = tubes_of(s);
  EXPECT_EQ(static_cast<std::int64_t>(tubes.size()), summarize_topology(to_soup(s)).components - 1);
  const SurfaceSeries series = close_topology(s, tubes);
  expect_sound(series);
  EXPECT_EQ(summarize_topology(to_soup(series.closed)).components, 1);
  EXPECT_EQ(hits_of_patches(series), 0);
}

TEST(ComponentTubes, CanBeCancelled) {
  PolygonSoup soup = ball(4);
  add(soup, ball(4, 2, Vec3(3, 0, 0)));
  const TriangleSurface s = repaired(soup);
  Context context;
  context.cancel();
  EXPECT_EQ(code_of([&] { find_tubes(s, {}, Progress(context)); }), ErrorCode::Cancelled);
}

}  // namespace
}  // namespace hybrid_mesh
