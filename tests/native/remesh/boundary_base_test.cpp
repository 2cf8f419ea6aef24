// SPDX-License-Identifier: GPL-3.0-or-later
// Bases of four points on a boundary and a chain of cubes.
#include <gtest/gtest.h>

#include <functional>

#include "codec/container.h"
#include "remesh/plan.h"
#include "remesh/plans.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::Json;
using testing::refusal_of;
using testing::run;

Json plan_with(const Json& base) { return {{"format", "hybrid-mesh plan"}, {"version", 1}, {"base", base}}; }

// On the rim of ball(n, 0.5).
Json rim_nodes() { return {{1, 0, 0.5}, {-1, 0.1, 0.5}, {0, 1, 0.5}, {0.1, -1, 0.5}}; }

RemeshOptions options_of(Refinement refinement) {
  RemeshOptions options;
  options.vertices = 3000;
  options.refinement = refinement;
  return options;
}

class BoundaryBases : public ::testing::TestWithParam<Refinement> {};
INSTANTIATE_TEST_SUITE_P(Remeshes, BoundaryBases, ::testing::Values(Refinement::Uniform, Refinement::Adaptive));

TEST_P(BoundaryBases, AreChainsOfCubesWhosePlanRepeatsThem) {
  const RemeshOptions options = options_of(GetParam());
  for (const Json& nodes : {rim_nodes(), Json("automatic")}) {
    const RemeshResult made = run(ball(24, 0.5), options, plan_with({{"boundary_nodes", nodes}, {"cubes", 2}}).dump());
    EXPECT_EQ(made.hierarchy.base_count(), 9);
    EXPECT_EQ(made.hierarchy.base_vertex_count(), 12);
    EXPECT_TRUE(find_defects(made.hierarchy).empty());
    const TopologySummary t = summarize_topology(to_soup(made.final_mesh));
    EXPECT_EQ(t.euler, 1);
    EXPECT_EQ(t.boundary_loops, 1);
    // Quads of different sizes meet on a surface of few triangles.
    EXPECT_LE(made.report["final"]["scaled_jacobian"]["inverted"].get<double>(), GetParam() == Refinement::Uniform ? 0 : 2e-3);
    EXPECT_LE(made.report["final"]["l2"].get<double>(), 2e-3);
    // The plan has the quads themselves.
    const Plan plan = plan_from_json(made.plan);
    EXPECT_FALSE(plan.tower);
    ASSERT_EQ(plan.base.quads.size(), 9u);
    EXPECT_EQ(to_json(plan), made.plan);
    const RemeshResult again = run(ball(24, 0.5), options, made.plan);
    EXPECT_EQ(encode_hierarchy(made.hierarchy, "{}"), encode_hierarchy(again.hierarchy, "{}"));
    EXPECT_EQ(made.plan, again.plan);
    const RemeshResult other = run(ball(17, 0.5), options, made.plan);
    EXPECT_EQ(other.hierarchy.base_count(), 9);
    EXPECT_EQ(summarize_topology(to_soup(other.final_mesh)).euler, 1);
  }
}

TEST(BoundaryBase, TakesOperations) {
  Json plan = plan_with({{"boundary_nodes", rim_nodes()}, {"cubes", 1}});
  // The first side's quads from the boundary up, and the middle of the top.
  plan["operations"] = Json::array({{{"level", 1}, {"quads", {"4.0", "4.1", "4.2", "4.3"}}, {"layout", "cubes"}, {"height", 1}},
                                    {{"level", 2}, {"quads", {"0.0.0", "0.0.1"}}, {"layout", "automatic"}}});
  RemeshOptions options;
  options.levels = 3;
  const RemeshResult made = run(ball(24, 0.5), options, plan.dump());
  EXPECT_EQ(made.hierarchy.operation_count(), 2);
  EXPECT_TRUE(find_defects(made.hierarchy).empty());
  EXPECT_EQ(plan_from_json(made.plan).regions.size(), 2u);
  const RemeshResult again = run(ball(24, 0.5), options, made.plan);
  EXPECT_EQ(encode_hierarchy(made.hierarchy, "{}"), encode_hierarchy(again.hierarchy, "{}"));
}

TEST(BoundaryBase, WhatIsWrongIsNamedWithItsPlace) {
  const Json good = plan_with({{"boundary_nodes", rim_nodes()}, {"cubes", 1}});
  EXPECT_EQ(to_json(plan_from_json(good.dump())), to_json(plan_from_json(to_json(plan_from_json(good.dump())))));
  const std::vector<std::pair<std::string, std::function<void(Json&)>>> mistakes = {
      {"base.boundary_nodes", [](Json& p) { p["base"]["boundary_nodes"].erase(0); }},
      {"base.boundary_nodes", [](Json& p) { p["base"]["boundary_nodes"] = "somewhere"; }},
      {"base.boundary_nodes[2][1]", [](Json& p) { p["base"]["boundary_nodes"][2][1] = "far"; }},
      {"base.cubes", [](Json& p) { p["base"]["cubes"] = -1; }},
      {"base.cubes", [](Json& p) { p["base"]["cubes"] = 1.5; }},
      {"quads", [](Json& p) { p["base"]["quads"] = Json::array(); }},
      {"origin", [](Json& p) { p["base"]["origin"] = Json::object(); }},
      {"levels", [](Json& p) { p["levels"] = Json::array(); }},
      {"one place", [](Json& p) { p["base"]["boundary_nodes"][1] = p["base"]["boundary_nodes"][0]; }},
  };
  for (const auto& [words, spoil] : mistakes) {
    Json bad = good;
    spoil(bad);
    const std::string refusal = refusal_of([&] { run(ball(12, 0.5), RemeshOptions(), bad.dump()); });
    EXPECT_NE(refusal.find(words), std::string::npos) << bad << ": " << refusal;
  }
  EXPECT_THROW(run(ball(12), RemeshOptions(), good.dump()), Error);
}

}  // namespace
}  // namespace hybrid_mesh
