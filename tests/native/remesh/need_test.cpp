// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/need.h"

#include <gtest/gtest.h>

#include <cmath>

#include "generated_surfaces.h"
#include "remesh/meshes.h"
#include "remesh/remesh.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

using testing::mesh_of;
using testing::repaired;

// A sheet of unit size, with a bump of that height in its middle.
PolygonSoup sheet(int n, double bump) {
  PolygonSoup soup = grid(n, n);
  for (Vec3& p : soup.points) {
    p /= n;
    const double x = (p.x() - 0.5) / 0.05, y = (p.y() - 0.5) / 0.05;
    p.z() = bump * std::exp(-x * x - y * y);
  }
  return soup;
}

double off_middle(const Vec3& p) { return std::hypot(p.x() - 0.5, p.y() - 0.5); }

TEST(Need, IsWhereTheMeshMissesTheSurface) {
  const TriangleSurface surface = repaired(sheet(80, 0.15));
  const QuadMesh flat = mesh_of(sheet(20, 0));
  Need need(surface);
  Context context;
  ASSERT_TRUE(need.learn_from(flat, Progress(context)));
  double least = 1;
  for (std::size_t v = 0; v < surface.points.size(); ++v) {
    const double size = need.size()[v];
    EXPECT_GT(size, 0);
    EXPECT_LE(size, 1);
    if (off_middle(surface.points[v]) > 0.3) {
      EXPECT_EQ(size, 1);
    }
    least = std::min(least, size);
  }
  EXPECT_LT(least, 0.7);
}

TEST(Need, NothingIsLearntFromAGoodMesh) {
  const TriangleSurface surface = repaired(sheet(80, 0.15));
  Need need(surface);
  Context context;
  EXPECT_FALSE(need.learn_from(mesh_of(sheet(80, 0.15)), Progress(context)));
  for (const double size : need.size()) EXPECT_EQ(size, 1);
}

TEST(Need, IsLearntStepByStepAndHasAnEnd) {
  const TriangleSurface surface = repaired(sheet(80, 0.15));
  const QuadMesh flat = mesh_of(sheet(20, 0));
  Need need(surface);
  Context context;
  int steps = 0;
  while (need.learn_from(flat, Progress(context))) ASSERT_LT(++steps, 20);
  EXPECT_GT(steps, 0);
  for (const double size : need.size()) EXPECT_GE(size, 0.25);
}

// A ball with long thin spikes: at so few vertices even quads lose some of them.
PolygonSoup spiky_ball() {
  PolygonSoup soup = testing::ball(60);
  for (Vec3& p : soup.points) {
    const Vec3 n = p.normalized();
    double out = 0;
    for (const Vec3& at : {Vec3(1, 0.1, 0.2), Vec3(-0.3, 1, 0.1), Vec3(0.1, -0.2, -1)})
      out += 1.2 * std::exp(-90 * (n - at.normalized()).squaredNorm());
    p = n * (1 + out);
  }
  return soup;
}

TEST(Need, APoorMeshIsMadeOnceMoreAndIsBetter) {
  RemeshOptions options;
  options.vertices = 500;  // too few for a finer base
  Context context;
  const RemeshResult r = remesh(spiky_ball(), options, context);
  EXPECT_TRUE(r.report["base"]["by_need"].get<bool>());
  EXPECT_EQ(r.report["verdict"]["result"], "good") << r.report["verdict"];
  EXPECT_LE(r.final_mesh.points.size(), 500U);
  EXPECT_GE(r.final_mesh.points.size(), 490U);
  // Of a base that is given nothing is made once more.
  options.base = BaseSize::Given;
  options.base_quads = r.report["base"]["quads"];
  const RemeshResult once = remesh(spiky_ball(), options, context);
  EXPECT_FALSE(once.report["base"]["by_need"].get<bool>());
  EXPECT_GT(once.report["final"]["hausdorff"].get<double>(), 1.2 * r.report["final"]["hausdorff"].get<double>());
}

TEST(Effort, APoorMeshGetsAFinerBase) {
  RemeshOptions options;
  options.vertices = 1200;
  Context context;
  const RemeshResult tried = remesh(spiky_ball(), options, context);
  options.effort = Effort::Quick;
  const RemeshResult first = remesh(spiky_ball(), options, context);
  EXPECT_EQ(first.report["verdict"]["result"], "poor");
  EXPECT_EQ(tried.report["verdict"]["result"], "good") << tried.report["verdict"];
  EXPECT_FALSE(tried.report["base"]["by_need"].get<bool>());
  EXPECT_GT(tried.report["base"]["quads"], 3 * first.report["base"]["quads"].get<int>());
  EXPECT_LE(tried.final_mesh.points.size(), 1200U);
}

TEST(Effort, WithNoneThePoorMeshIsTheResult) {
  RemeshOptions options;
  options.vertices = 1200;
  options.effort = Effort::Quick;
  Context context;
  const RemeshResult r = remesh(spiky_ball(), options, context);
  EXPECT_FALSE(r.report["base"]["by_need"].get<bool>());
  EXPECT_EQ(r.report["verdict"]["result"], "poor");
}

TEST(Effort, AGoodMeshIsTheSameWithAny) {
  RemeshOptions options;
  options.vertices = 1200;
  Context context;
  const RemeshResult normal = remesh(testing::ball(20), options, context);
  ASSERT_EQ(normal.report["verdict"]["result"], "good");
  for (const Effort effort : {Effort::Quick, Effort::Thorough}) {
    options.effort = effort;
    EXPECT_EQ(remesh(testing::ball(20), options, context).final_mesh.points, normal.final_mesh.points);
  }
}

}  // namespace
}  // namespace hybrid_mesh
