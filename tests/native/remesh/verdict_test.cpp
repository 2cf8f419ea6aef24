// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/verdict.h"

#include <gtest/gtest.h>

#include <set>

#include "generated_surfaces.h"
#include "remesh/remesh.h"
#include "shapes.h"
#include "surface/closest_point.h"
#include "surface/triangulation.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::torus;

struct Change {
  std::int64_t vertices = 2000;
  BaseSize base = BaseSize::Auto;
  int base_quads = 0, levels = -1;
  double error = 0;
  Refinement refinement = Refinement::Uniform;
  bool semi_regular = false;
  double drop_components = 0;
  std::string plan = {};
};

RemeshResult run(const PolygonSoup& soup, const Change& change) {
  RemeshOptions options;
  options.vertices = change.vertices;
  options.base = change.base;
  options.base_quads = change.base_quads;
  options.levels = change.levels;
  options.error = change.error;
  options.refinement = change.refinement;
  options.semi_regular = change.semi_regular;
  options.drop_components = change.drop_components;
  options.plan = change.plan;
  Context context;
  return remesh(soup, options, context);
}

std::set<std::string> reasons(const RemeshResult& r) {
  std::set<std::string> found;
  const auto& verdict = r.report["verdict"];
  for (const auto& reason : verdict["reasons"]) {
    EXPECT_FALSE(reason["text"].get<std::string>().empty());
    EXPECT_TRUE(found.insert(reason["what"].get<std::string>()).second);
  }
  EXPECT_EQ(verdict["result"], found.empty() ? "good" : "poor");
  return found;
}

using Keys = std::set<std::string>;

PolygonSoup sheet() {
  PolygonSoup soup = grid(40, 40);
  for (Vec3& p : soup.points) p.z() = 4 * std::sin(p.x() / 9) * std::cos(p.y() / 11);
  return soup;
}

void expect_good(const PolygonSoup& soup, Refinement refinement) {
  const RemeshResult r = run(soup, {.vertices = 3000, .refinement = refinement});
  EXPECT_EQ(reasons(r), Keys{});
  EXPECT_EQ(r.report["final"]["self_intersections"], 0);
  EXPECT_TRUE(r.report["warnings"].empty());
}

TEST(Verdict, GoodOnesAreGood) {
  for (const PolygonSoup& soup : {ball(20), torus(60, 30), sheet()}) expect_good(soup, Refinement::Uniform);
  expect_good(torus(60, 30), Refinement::Adaptive);
}

TEST(Verdict, BallsThatRunThroughOneAnotherMayDoSo) {
  PolygonSoup both = ball(20);
  testing::add(both, ball(20, 2, Vec3(1.2, 0.1, 0.05)));
  const RemeshResult r = run(both, {.vertices = 4000});
  EXPECT_EQ(reasons(r), Keys{});
  EXPECT_EQ(r.report["final"]["self_intersections"], 0);
  EXPECT_GT(r.report["final"]["self_intersections_of_input"], 20);
}

TEST(Verdict, WhatIsRemovedAsAskedIsNotMissed) {
  PolygonSoup soup = ball(20);
  testing::add(soup, ball(3, 2, Vec3(4, 0, 0), 0.05));
  const RemeshResult r = run(soup, {.drop_components = 0.1});
  EXPECT_GT(r.report["final"]["hausdorff"], 0.1);
  EXPECT_EQ(reasons(r), Keys{});
}

// On a least base each level has four times the quads of the one below: most of a bound between two is left.
TEST(Verdict, VerticesThatAreLeftAreSaidUnlessTheUserChoseTheBase) {
  const PolygonSoup soup = ball(20);
  EXPECT_EQ(reasons(run(soup, {.vertices = 5000, .base = BaseSize::Minimal, .semi_regular = true})), Keys{"vertices"});
  EXPECT_EQ(reasons(run(soup, {.vertices = 5000, .base = BaseSize::Minimal, .levels = 3, .semi_regular = true})), Keys{});
  EXPECT_EQ(reasons(run(soup, {.vertices = 5000, .base = BaseSize::Minimal, .refinement = Refinement::Adaptive, .semi_regular = true})), Keys{});
  const RemeshResult given = run(soup, {.vertices = 5000, .base = BaseSize::Given, .base_quads = 40});
  ASSERT_LT(given.final_mesh.points.size(), 4900u);
  EXPECT_EQ(reasons(given), Keys{});
  EXPECT_EQ(reasons(run(soup, {.vertices = 5000, .plan = given.plan})), Keys{});
  EXPECT_EQ(reasons(run(soup, {.vertices = 5000, .error = 3e-4})), Keys{});
}

TEST(Verdict, ABoundOnTheErrorThatIsMissedIsSaid) { EXPECT_EQ(reasons(run(torus(60, 30), {.vertices = 1000, .error = 1e-6})), Keys{"error"}); }

// A ball with a rod of 60 times its width, in far fewer quads than go around it; nowhere near the origin.
PolygonSoup ball_with_needle() {
  PolygonSoup soup = ball(40);
  for (Vec3& p : soup.points) {
    const double off = (p.normalized() - Vec3::UnitX()).squaredNorm();
    p += 4 * std::exp(-off / (0.05 * 0.05)) * Vec3::UnitX();
    p = 10 * p + Vec3(300, -200, 70);
  }
  return soup;
}

TEST(Verdict, ALostNeedleIsSaidWithItsPlace) {
  const PolygonSoup soup = ball_with_needle();
  const RemeshResult r = run(soup, {.vertices = 60, .base = BaseSize::Given, .base_quads = 12});
  ASSERT_TRUE(reasons(r).count("hausdorff"));
  for (const auto& reason : r.report["verdict"]["reasons"])
    if (reason["what"] == "hausdorff") {
      const Vec3 where(reason["where"][0], reason["where"][1], reason["where"][2]);
      // As far from the mesh as it is said to be.
      const SurfaceDistanceQuery query(r.final_mesh.points, triangulate(to_soup(r.final_mesh)).triangles);
      double length = 0;
      for (const Vec3& p : soup.points) length = std::max(length, p.x());
      EXPECT_GT(std::sqrt(query.closest(where).squared_distance), 1);
      EXPECT_GT(where.x(), 320);
      EXPECT_LE(where.x(), length + 1e-6);
    }
}

}  // namespace
}  // namespace hybrid_mesh
