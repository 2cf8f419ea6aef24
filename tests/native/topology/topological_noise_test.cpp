// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/topological_noise.h"

#include <gtest/gtest.h>

#include "closed_and_opened.h"

namespace hybrid_mesh {
namespace {

using namespace testing;

ClosedNoise without_noise(const TriangleSurface& s, double length) {
  Context context;
  return close_noise(s, length, Progress(context));
}

TEST(TopologicalNoise, IsClosedAndTheRestStays) {
  TriangleSurface s = noisy_ball(30, 150);
  const int from = face_towards(s, Vec3(1, 1, 1)), to = face_towards(s, Vec3(-1, 1, 1));
  join_faces(s, from, to, 20, 1);
  finish(s);
  const double genus = summarize_topology(to_soup(s)).genus;
  ASSERT_EQ(genus, 151);
  const ClosedNoise closed = without_noise(s, 0.6);
  expect_manifold(closed.surface);
  EXPECT_EQ(summarize_topology(to_soup(closed.surface)).genus, genus - closed.handles);
  EXPECT_EQ(closed.handles, 151);  // the large one is as thin as the others
  ASSERT_EQ(closed.point_origin.size(), closed.surface.points.size());
  for (std::size_t v = 0; v < closed.point_origin.size(); ++v)
    if (closed.point_origin[v] >= 0) {
      EXPECT_EQ(closed.surface.points[v], s.points[closed.point_origin[v]]);
    }
}

TEST(TopologicalNoise, LeavesWhatIsLonger) {
  const TriangleSurface s = repaired(plate_with_windows(3, 4));
  const auto loops = loops_of(s);
  const ClosedNoise none = without_noise(s, 0.9 * loops[0].length);
  EXPECT_EQ(none.handles, 0);
  EXPECT_EQ(none.surface.faces, s.faces);
  EXPECT_EQ(summarize_topology(to_soup(without_noise(s, 2 * loops[2].length).surface)).genus, 0);
}

}  // namespace
}  // namespace hybrid_mesh
