// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces with holes: their minimal base is mapped at once, and holds no more quads than the holes need.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "generated_surfaces.h"
#include "remesh/remesh.h"
#include "soundness.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

// A ball without the triangles near some directions: the boundaries are jagged, and have triangles that hang on one side only.
PolygonSoup ball_with_holes(int n, const std::vector<Vec3>& holes, double angle) {
  const PolygonSoup ball = testing::ball(n);
  PolygonSoup s;
  s.points = ball.points;
  for (std::size_t p = 0; p < ball.polygon_count(); ++p) {
    Vec3 middle = Vec3::Zero();
    for (std::int64_t i = ball.offsets[p]; i < ball.offsets[p + 1]; ++i) middle += ball.points[ball.indices[i]];
    middle.normalize();
    if (std::any_of(holes.begin(), holes.end(), [&](const Vec3& h) { return middle.dot(h.normalized()) > std::cos(angle); })) continue;
    for (std::int64_t i = ball.offsets[p]; i < ball.offsets[p + 1]; ++i) s.indices.push_back(ball.indices[i]);
    s.offsets.push_back(static_cast<std::int64_t>(s.indices.size()));
  }
  return s;
}

TEST(Holes, AMinimalBaseIsMappedAtOnce) {
  const PolygonSoup soup = ball_with_holes(30, {{1, 0.2, 0.1}, {-0.3, 1, 0.2}, {0.1, -0.3, 1}, {-1, -0.4, -0.2}, {0.3, 0.2, -1}}, 0.25);
  RemeshOptions options;
  options.vertices = 4000;
  options.refinement = Refinement::Adaptive;
  options.base = BaseSize::Minimal;
  Context context;
  const RemeshResult r = remesh(soup, options, context);
  EXPECT_LE(r.report["base"]["quads"].get<int>(), 32);
  EXPECT_EQ(summarize_topology(to_soup(r.repaired)).boundary_loops, 5);
  testing::expect_sound(r);
  EXPECT_LE(r.report["final"]["l2"].get<double>(), 1e-3);
  testing::expect_maps_without_defects(r.hierarchy);
}

}  // namespace
}  // namespace hybrid_mesh
