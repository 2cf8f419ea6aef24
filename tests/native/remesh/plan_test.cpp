// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/plan.h"

#include <gtest/gtest.h>

#include <functional>

#include "codec/container.h"
#include "remesh/plans.h"
#include "surface/closest_point.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::corners_of;
using testing::cube_plan;
using testing::expect_changed_in_places;
using testing::Json;
using testing::node_at;
using testing::refusal_of;
using testing::run;
using testing::spiked_ball;
using testing::torus;

RemeshOptions options_of(BaseSize base, Refinement refinement) {
  RemeshOptions options;
  options.vertices = 4000;
  options.base = base;
  options.refinement = refinement;
  return options;
}

class PlanKinds : public ::testing::TestWithParam<std::tuple<BaseSize, Refinement>> {
 protected:
  RemeshOptions options() const { return options_of(std::get<0>(GetParam()), std::get<1>(GetParam())); }
};
INSTANTIATE_TEST_SUITE_P(Remeshes, PlanKinds,
                         ::testing::Combine(::testing::Values(BaseSize::Auto, BaseSize::Minimal),
                                            ::testing::Values(Refinement::Uniform, Refinement::Adaptive)));

TEST_P(PlanKinds, RepeatARemeshByteForByte) {
  for (const PolygonSoup& soup : {spiked_ball(30), ball(14, 0.5), torus(40, 20)}) {
    const RemeshResult first = run(soup, options());
    RemeshOptions other = options();
    // What is decided by the plan does not depend on these.
    other.seed = 77;
    other.base = BaseSize::Auto;
    const RemeshResult again = run(soup, other, first.plan);
    EXPECT_EQ(encode_hierarchy(first.hierarchy, "{}"), encode_hierarchy(again.hierarchy, "{}"));
    EXPECT_EQ(first.plan, again.plan);
    EXPECT_EQ(to_json(plan_from_json(first.plan)), first.plan);
  }
}

TEST_P(PlanKinds, LayTheSameQuadsOnAnotherTriangulation) {
  const RemeshResult coarse = run(spiked_ball(24), options());
  const PolygonSoup fine = spiked_ball(37);
  const RemeshResult laid = run(fine, options(), coarse.plan), own = run(fine, options());
  EXPECT_TRUE(find_defects(laid.hierarchy).empty());
  EXPECT_EQ(laid.hierarchy.base_count(), coarse.hierarchy.base_count());
  EXPECT_EQ(laid.hierarchy.operation_count(), coarse.hierarchy.operation_count());
  for (int i = 0; i < laid.hierarchy.operation_count(); ++i) {
    EXPECT_EQ(laid.hierarchy.operation(i).repatch.level, coarse.hierarchy.operation(i).repatch.level);
    EXPECT_EQ(laid.hierarchy.operation(i).roots.size(), coarse.hierarchy.operation(i).roots.size());
  }
  const TopologySummary t = summarize_topology(to_soup(laid.final_mesh));
  EXPECT_EQ(t.euler, 2);
  EXPECT_EQ(t.nonmanifold_edges + t.nonmanifold_vertices + t.misoriented_edges, 0);
  EXPECT_LE(t.vertices, 4000);
  EXPECT_LE(laid.report["final"]["l2"].get<double>(), 1.3 * own.report["final"]["l2"].get<double>());
}

TEST(Plan, ABaseChangedByHandIsAnotherOne) {
  const PolygonSoup soup = ball(24);
  const RemeshOptions options = options_of(BaseSize::Auto, Refinement::Uniform);
  const RemeshResult first = run(soup, options);
  Json plan = Json::parse(first.plan);
  plan["base"].erase("curves");
  for (Json& c : plan["base"]["nodes"][0]) c = 0.999 * c.get<double>() + 1e-3;
  const RemeshResult moved = run(soup, options, plan.dump());
  EXPECT_NE(encode_hierarchy(first.hierarchy, "{}"), encode_hierarchy(moved.hierarchy, "{}"));
  EXPECT_EQ(moved.hierarchy.base_count(), first.hierarchy.base_count());
}

// A plan as a person might write it: a cube for a ball, and a tower on one of its quads' children.
TEST(Plan, ByHand) {
  Json plan = cube_plan();
  plan["operations"] = Json::array({{{"level", 2}, {"quads", {"1.0.2"}}, {"layout", "cubes"}, {"height", 2}}});
  RemeshOptions options;
  options.levels = 4;
  const RemeshResult made = run(ball(24), options, plan.dump());
  EXPECT_EQ(made.hierarchy.base_count(), 6);
  ASSERT_EQ(made.hierarchy.operation_count(), 1);
  EXPECT_EQ(made.hierarchy.operation(0).repatch.level, 2);
  EXPECT_EQ(made.hierarchy.operation(0).roots.size(), 9u);
  EXPECT_TRUE(find_defects(made.hierarchy).empty());
  EXPECT_EQ(summarize_topology(to_soup(made.final_mesh)).euler, 2);
}

// The star around the middle of a base quad is turned: its middle is joined to the region's corners instead of their midpoints.
class DrawnRegions : public ::testing::TestWithParam<int> {
 protected:
  DrawnRegions() {
    options_.levels = 4;
    plain_ = run(soup_, options_, plan_.dump());
    const auto at = corners_of(plain_.hierarchy, 2);
    Json quads = Json::array(), curves = Json::array();
    for (int k = 0; k < 4; ++k) {
      quads.push_back("1." + std::to_string(k) + "." + std::to_string((k + 2) % 4));
      const int node = node_at(plain_.hierarchy, 1, {k, (k + 2) % 4});
      removed_.push_back(node);
      const Vec3 corner = at.at({node, k}), middle = at.at({node, (k + 2) % 4});
      curves.push_back({{"points", {{corner.x(), corner.y(), corner.z()}, {middle.x(), middle.y(), middle.z()}}}});
    }
    operation_ = {{"level", 2}, {"quads", quads}, {"curves", curves}, {"buffer_rings", GetParam()}};
  }
  const PolygonSoup soup_ = ball(24);
  RemeshOptions options_;
  Json plan_ = cube_plan(), operation_;
  RemeshResult plain_;
  std::vector<int> removed_;
};
INSTANTIATE_TEST_SUITE_P(BufferRings, DrawnRegions, ::testing::Values(0, 1, 2));

TEST_P(DrawnRegions, AreLaidOutAnewAndNothingElseChanges) {
  plan_["operations"] = Json::array({operation_});
  const RemeshResult made = run(soup_, options_, plan_.dump());
  const HybridMesh& h = made.hierarchy;
  ASSERT_EQ(h.operation_count(), 1);
  EXPECT_EQ(h.operation(0).repatch.removed.size(), 4u);
  EXPECT_EQ(h.operation(0).roots.size(), 4u);
  // Maps: those of the new quads, and of as many rings around as were asked for; two of them reach over the cube's edges, at whose ends three quads
  // meet.
  EXPECT_EQ(expect_changed_in_places(plain_.hierarchy, h, 2), std::vector<int>({4, 16, 32})[GetParam()]);
  // All maps meet along their sides.
  const QuadMesh fine = h.level_mesh(4);
  for (std::size_t f = 0; f < fine.face_count(); ++f)
    for (int i = 0; i < 4; ++i) {
      const SideLink other = h.neighbour(fine.node[f], i);
      ASSERT_TRUE(other.valid());
      for (const auto& [a, b] : {std::pair(i, (other.side + 1) % 4), std::pair((i + 1) % 4, other.side)}) {
        const auto place = [&](int node, int corner) {
          const int owner = h.map_owner(node);
          const HybridMesh::Square s = h.square_in(node, owner);
          return h.sample(MapLocation{owner, s.u + s.width * (corner == 1 || corner == 2), s.v + s.width * (corner >= 2)}).position;
        };
        EXPECT_NEAR((place(fine.node[f], a) - place(other.node, b)).norm(), 0, 2e-7);  // weights of sources are single-precision
      }
    }
  const RemeshResult again = run(soup_, options_, made.plan);
  EXPECT_EQ(encode_hierarchy(h, "{}"), encode_hierarchy(again.hierarchy, "{}"));
}

TEST_P(DrawnRegions, FacesOfMoreThanFourSidesAreFilled) {
  for (const int kept : {0, 3}) {
    Json few = operation_;
    while (static_cast<int>(few["curves"].size()) > kept) few["curves"].erase(0);
    plan_["operations"] = Json::array({few});
    const RemeshResult made = run(soup_, options_, plan_.dump());
    ASSERT_EQ(made.hierarchy.operation_count(), 1);
    EXPECT_EQ(made.hierarchy.operation(0).repatch.removed.size(), 4u);
    expect_changed_in_places(plain_.hierarchy, made.hierarchy, 2);
    // Nothing drawn: as regular as it was.
    if (kept == 0) {
      EXPECT_EQ(made.hierarchy.operation(0).roots.size(), 4u);
    }
    const RemeshResult again = run(soup_, options_, made.plan);
    EXPECT_EQ(encode_hierarchy(made.hierarchy, "{}"), encode_hierarchy(again.hierarchy, "{}"));
  }
}

TEST_P(DrawnRegions, ProblemsAreNamedWhereTheyAre) {
  const auto problems = [&](const Json& operation) {
    plan_["operations"] = Json::array({operation});
    try {
      run(soup_, options_, plan_.dump());
    } catch (const LayoutError& e) {
      return e.problems;
    }
    return std::vector<LayoutProblem>();
  };
  // To the middle of a side instead of a corner: faces of three and five sides.
  Json odd = operation_;
  const Vec3 between = corners_of(plain_.hierarchy, 2).at({removed_[0], 1});
  odd["curves"][0]["points"][0] = {between.x(), between.y(), between.z()};
  const auto odd_sides = problems(odd);
  ASSERT_EQ(odd_sides.size(), 2u);
  const SurfaceDistanceQuery query(plain_.repaired.points, plain_.repaired.faces);
  for (const LayoutProblem& p : odd_sides) {
    EXPECT_STREQ(name_of(p.kind), "odd_sides");
    for (const Vec3& x : p.where) EXPECT_LE(std::sqrt(query.closest(x).squared_distance), 1e-6);  // in the input's space
  }
  Json short_one = operation_;
  short_one["curves"][0]["points"][0] = short_one["curves"][0]["points"][1];
  for (int i = 0; i < 3; ++i)
    short_one["curves"][0]["points"][0][i] =
        0.5 * operation_["curves"][0]["points"][0][i].get<double>() + 0.5 * operation_["curves"][0]["points"][1][i].get<double>();
  bool dangling = false;
  for (const LayoutProblem& p : problems(short_one)) dangling |= p.kind == LayoutProblem::Kind::Dangling;
  EXPECT_TRUE(dangling);
  const std::vector<std::function<void(Json&)>> mistakes = {[](Json& o) { o["quads"][0] = "1.0"; },
                                                            [](Json& o) {
                                                              o["quads"] = {"1.0.0", "1.2.2"};
                                                            },
                                                            [](Json& o) { o["level"] = 0; }, [](Json& o) { o["buffer_rings"] = -1; },
                                                            [](Json& o) { o["quads"] = Json::array(); }};
  for (const auto& spoil : mistakes) {
    Json bad = operation_;
    spoil(bad);
    plan_["operations"] = Json::array({bad});
    EXPECT_THROW(run(soup_, options_, plan_.dump()), Error);
  }
}

TEST(Plan, AnOperationBeginsOnTheBoundaryOfItsQuads) {
  RemeshOptions options;
  options.levels = 2;
  for (int side = 0; side < 4; ++side) {
    Json plan = cube_plan();
    const Json star = {{0, 1, 2, 8}, {2, 3, 4, 8}, {4, 5, 6, 8}, {6, 7, 0, 8}};
    plan["operations"] = {
        {{"level", 1}, {"quads", {"0.0", "0.1", "0.2", "0.3"}}, {"layout", "template"}, {"start", {"0.0", side}}, {"new_quads", star}}};
    const std::string said = refusal_of([&] { run(ball(12), options, plan.dump()); });
    // Sides 1 and 2 lead to the middle of the four, and from it.
    EXPECT_EQ(said.find("operations[0]") != std::string::npos, side == 1 || side == 2) << said;
    EXPECT_EQ(said.empty(), side == 0 || side == 3) << said;
  }
}

TEST(Plan, EditsOfAnotherBaseAreNotMadeOnThisOne) {
  const PolygonSoup soup = ball(24);
  const RemeshOptions options = options_of(BaseSize::Auto, Refinement::Uniform);
  const RemeshResult first = run(soup, options);
  const Json plan = Json::parse(first.plan);
  ASSERT_FALSE(plan["base"]["origin"]["rounds"].empty());
  ASSERT_FALSE(plan["base"]["origin"]["rounds"][0].empty());
  const std::vector<std::function<void(Json&)>> mistakes = {
      [](Json& edit) { edit["patches"][0] = 999999; },      [](Json& edit) { edit["start"][0] = 2147483640; },
      [](Json& edit) { edit["quads"][0][0] = 1000000000; }, [](Json& edit) { edit["inner_nodes"] = 2147483647; },
      [](Json& edit) { edit["rings"] = 1000000000; },       [](Json& edit) { edit["quads"].erase(0); },
  };
  for (const auto& spoil : mistakes) {
    Json bad = plan;
    spoil(bad["base"]["origin"]["rounds"][0][0]);
    // It is laid out along the plan's lines instead.
    const RemeshResult made = run(soup, options, bad.dump());
    EXPECT_EQ(made.hierarchy.base_count(), first.hierarchy.base_count());
  }
}

TEST(Plan, WhatIsWrongIsNamedWithItsPlace) {
  const RemeshResult made = run(spiked_ball(24), options_of(BaseSize::Minimal, Refinement::Uniform));
  const Json good = Json::parse(made.plan);
  const auto refused = [](const Json& plan) {
    return refusal_of([&] { plan_from_json(plan.dump()); }, {ErrorCode::InvalidInput, ErrorCode::Unsupported});
  };
  EXPECT_EQ(refused(good), "");
  EXPECT_THROW(plan_from_json("{"), Error);
  EXPECT_THROW(plan_from_json("[]"), Error);
  const Json& even = good["operations"][0];
  EXPECT_EQ(even["layout"], "even");
  EXPECT_EQ(even["level"], made.hierarchy.operation(0).repatch.level);
  const std::string operation = "operations[0]";
  const std::vector<std::pair<std::string, std::function<void(Json&)>>> mistakes = {
      {"format", [](Json& p) { p["format"] = "a plan"; }},
      {"version", [](Json& p) { p["version"] = 0; }},
      {"version 9", [](Json& p) { p["version"] = 9; }},
      {"no \"base\"", [](Json& p) { p.erase("base"); }},
      {"colour", [](Json& p) { p["base"]["colour"] = 1; }},
      {"base.nodes[1]",
       [](Json& p) {
         p["base"]["nodes"][1] = {1, 2};
       }},
      {"base.nodes[1][2]", [](Json& p) { p["base"]["nodes"][1][2] = "far"; }},
      {"base.quads[0][3]", [](Json& p) { p["base"]["quads"][0][3] = 1000; }},
      {"base.quads[0][0]", [](Json& p) { p["base"]["quads"][0][0] = 0.5; }},
      {"base.quads[0][0]", [](Json& p) { p["base"]["quads"][0][0] = 18446744073709551615u; }},
      {"base.neighbours", [](Json& p) { p["base"]["neighbours"].erase(0); }},
      {"base.neighbours[0][0]",
       [](Json& p) {
         p["base"]["neighbours"][0][0] = {0, 3};
       }},
      {operation + ".layout", [](Json& p) { p["operations"][0]["layout"] = "magic"; }},
      {operation + ".quads[0]", [](Json& p) { p["operations"][0]["quads"][0] = 7; }},
      {operation + " has no \"start\"",
       [](Json& p) {
         p["operations"][0].erase("start");
         p["operations"][0].erase("starts");
       }},
      {operation + ".nodes", [](Json& p) { p["operations"][0]["nodes"].erase(0); }},
      {operation + ".sides[0].quad", [](Json& p) { p["operations"][0]["sides"][0]["quad"] = 99999; }},
      {operation + ".new_quads[0]", [](Json& p) { p["operations"][0]["new_quads"][0].erase(0); }},
      {operation + ".level", [](Json& p) { p["operations"][0]["level"] = 99; }},
  };
  for (const auto& [place, spoil] : mistakes) {
    Json bad = good;
    spoil(bad);
    EXPECT_NE(refused(bad).find(place), std::string::npos) << place << ": " << refused(bad);
  }
}

TEST(Plan, WhatFitsNoQuadsIsNamedWithItsPlace) {
  const PolygonSoup soup = spiked_ball(24);
  const RemeshOptions options = options_of(BaseSize::Minimal, Refinement::Uniform);
  const Json good = Json::parse(run(soup, options).plan);
  const std::vector<std::pair<std::string, std::function<void(Json&)>>> mistakes = {
      {"operations[0]: level", [](Json& p) { p["operations"][0]["quads"][0] = "0.9"; }},
      {"operations[0]", [](Json& p) { p["operations"][0]["quads"].erase(0); }},
      // Billions of quads would have to have addresses before it is found that none of them is named.
      {"operations[0]: level 12", [](Json& p) { p["operations"][0]["level"] = 12; }},
  };
  for (const auto& [place, spoil] : mistakes) {
    Json bad = good;
    spoil(bad);
    const std::string said = refusal_of([&] { run(soup, options, bad.dump()); });
    EXPECT_NE(said.find(place), std::string::npos) << place << ": " << said;
  }
}

TEST(Plan, ASurfaceOfOtherTopologyIsRefused) {
  const RemeshOptions options = options_of(BaseSize::Auto, Refinement::Uniform);
  const std::string plan = run(ball(20), options).plan;
  const std::string refusal = refusal_of([&] { run(torus(40, 20), options, plan); });
  EXPECT_NE(refusal.find("Euler number"), std::string::npos) << refusal;
  RemeshOptions few = options;
  few.vertices = 30;
  EXPECT_THROW(run(ball(20), few, plan), Error);
}

}  // namespace
}  // namespace hybrid_mesh
