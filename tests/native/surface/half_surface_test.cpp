// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/half_surface.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shapes.h"
#include "surface/topology_summary.h"
#include "symmetric_shapes.h"

namespace hybrid_mesh {
namespace {

using testing::bumpy_ball;
using testing::repaired;

const MirrorPlane kAcrossX{Vec3::UnitX(), 0};

Vec3 point_of(const TriangleSurface& surface, const SurfacePoint& place) {
  Vec3 p = Vec3::Zero();
  for (int i = 0; i < 3; ++i) p += place.weights[i] * surface.points[surface.faces[place.face][i]];
  return p;
}

// What holds for every half: a manifold on one side, with its cut exactly in the plane, of which every point is where it was.
void expect_half(const HalfSurface& half, const TriangleSurface& whole, const MirrorPlane& plane) {
  const TopologySummary t = summarize_topology(to_soup(half.mesh));
  EXPECT_EQ(t.nonmanifold_edges + t.nonmanifold_vertices + t.misoriented_edges, 0);
  const double diagonal = 10;  // more than that of any surface here
  for (std::size_t v = 0; v < half.mesh.points.size(); ++v) {
    const double height = plane.height(half.mesh.points[v]);
    if (half.on_plane[v]) {
      EXPECT_NEAR(height, 0, 1e-15);
    } else {
      EXPECT_GT(height, 0);
    }
    EXPECT_LT((point_of(whole, half.place[v]) - half.mesh.points[v]).norm(), 2e-5 * diagonal);
  }
  for (int h = 0; h < static_cast<int>(half.mesh.opposite.size()); ++h)
    if (half.mesh.opposite[h] >= 0) {
      EXPECT_FALSE(half.on_plane[half.mesh.from(h)] && half.on_plane[half.mesh.to(h)]) << "an inner edge joins two points of the cut";
    }
}

TEST(HalfSurface, JoinedWithItsImageHasTheWholesTopology) {
  const std::vector<std::pair<TriangleSurface, MirrorPlane>> all{{repaired(bumpy_ball(16, 0)), kAcrossX},
                                                                 {repaired(bumpy_ball(16, 0, 0.5)), kAcrossX},
                                                                 {repaired(testing::torus(40, 20)), kAcrossX},
                                                                 {repaired(testing::torus(40, 20)), {Vec3(0, 0, -1), 0.03}},
                                                                 {repaired(testing::torus(40, 20)), {Vec3(1, 2, 3).normalized(), 0.01}}};
  for (const auto& [whole, plane] : all) {
    const HalfSurface half = cut_in_half(whole, plane);
    expect_half(half, whole, plane);
    const TopologySummary before = summarize_topology(to_soup(whole)), after = summarize_topology(to_soup(joined_with_image(half, plane)));
    EXPECT_EQ(after.nonmanifold_edges + after.nonmanifold_vertices + after.misoriented_edges, 0);
    EXPECT_EQ(after.genus, before.genus);
    EXPECT_EQ(after.boundary_loops, before.boundary_loops);
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(after.euler, 2 * summarize_topology(to_soup(half.mesh)).euler - half.cut_euler);
  }
}

TEST(HalfSurface, EndsOfTheCutAreItsCorners) {
  const HalfSurface closed = cut_in_half(repaired(bumpy_ball(16, 0)), kAcrossX), open = cut_in_half(repaired(bumpy_ball(16, 0, 0.5)), kAcrossX);
  EXPECT_EQ(std::count(closed.corner.begin(), closed.corner.end(), 1), 0);
  EXPECT_EQ(closed.cut_euler, 0);
  EXPECT_EQ(std::count(open.corner.begin(), open.corner.end(), 1), 2);
  EXPECT_EQ(open.cut_euler, 1);
}

TEST(HalfSurface, CutThroughVerticesAddsNone) {
  // A box of eight blocks: the plane goes along its edges.
  std::vector<Vec3> points;
  std::vector<std::vector<int>> quads;
  for (const double z : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double x : {-1.0, 0.0, 1.0}) points.push_back({x, y, z});
  const auto at = [](int x, int y, int z) { return x + 3 * y + 6 * z; };
  for (int x = 0; x < 2; ++x) {
    quads.push_back({at(x, 0, 0), at(x, 1, 0), at(x + 1, 1, 0), at(x + 1, 0, 0)});
    quads.push_back({at(x, 0, 1), at(x + 1, 0, 1), at(x + 1, 1, 1), at(x, 1, 1)});
    quads.push_back({at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, 0, 1), at(x, 0, 1)});
    quads.push_back({at(x, 1, 0), at(x, 1, 1), at(x + 1, 1, 1), at(x + 1, 1, 0)});
  }
  quads.push_back({at(0, 0, 0), at(0, 0, 1), at(0, 1, 1), at(0, 1, 0)});
  quads.push_back({at(2, 0, 0), at(2, 1, 0), at(2, 1, 1), at(2, 0, 1)});
  const TriangleSurface box = repaired(shapes::soup_of(points, quads));
  const HalfSurface half = cut_in_half(box, kAcrossX);
  expect_half(half, box, kAcrossX);
  EXPECT_EQ(half.mesh.points.size(), 8U);
  EXPECT_EQ(half.mesh.faces.size(), box.faces.size() / 2);
  // What only touches the plane is on one side of it.
  EXPECT_THROW(cut_in_half(box, {Vec3::UnitX(), -1 + 1e-9}), Error);
}

TEST(HalfSurface, OfASurfaceOnOneSideIsAnError) {
  const TriangleSurface ball = repaired(bumpy_ball(8, 0));
  for (const double offset : {5.0, -5.0}) EXPECT_THROW(cut_in_half(ball, {Vec3::UnitX(), offset}), Error);
}

TEST(HalfSurface, PiecesThatThePlaneDoesNotTouchArePairs) {
  PolygonSoup two = testing::ball(8, 2, Vec3(3, 0, 0));
  testing::add(two, testing::ball(8, 2, Vec3(-3, 0, 0)));
  const HalfSurface half = cut_in_half(repaired(two), kAcrossX);
  EXPECT_EQ(half.cut_euler, 0);
  EXPECT_EQ(std::count(half.on_plane.begin(), half.on_plane.end(), 1), 0);
  EXPECT_EQ(summarize_topology(to_soup(joined_with_image(half, kAcrossX))).components, 2);
}

TEST(HalfSurface, AverageIsHalfWayAndNearlySymmetric) {
  Context context;
  const Progress progress(context);
  const TriangleSurface whole = repaired(bumpy_ball(24, 0.1)), mean = averaged_with_image(whole, kAcrossX, progress);
  const Asymmetry before = asymmetry(whole, kAcrossX, progress), after = asymmetry(mean, kAcrossX, progress);
  EXPECT_LT(after.largest, 0.25 * before.largest);
  double most = 0;
  for (std::size_t v = 0; v < whole.points.size(); ++v) most = std::max(most, (mean.points[v] - whole.points[v]).norm());
  EXPECT_GT(most, 0.03);  // half of the bump
  EXPECT_LT(most, 0.07);
}

}  // namespace
}  // namespace hybrid_mesh
