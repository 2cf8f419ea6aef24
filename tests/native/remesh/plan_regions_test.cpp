// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/plan_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "codec/container.h"
#include "hierarchy/operation_template.h"
#include "layout/regions/region_pattern.h"
#include "remesh/plans.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::cube_plan;
using testing::expect_changed_in_places;
using testing::Json;
using testing::refusal_of;
using testing::run;

// A ball in six quads, and level 2 of it without operations.
class PatternRegions : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { plain_ = new RemeshResult(run(ball(24), options(), cube_plan().dump())); }
  static void TearDownTestSuite() {
    delete plain_;
    plain_ = nullptr;
  }
  static RemeshOptions options() {
    RemeshOptions options;
    options.levels = 4;
    return options;
  }
  static RemeshResult remesh_with(const Json& operations) {
    Json plan = cube_plan();
    plan["operations"] = operations;
    return run(ball(24), options(), plan.dump());
  }
  // As the valences of level 2's vertices tell: how many of the operation's corners are irregular.
  static int irregular_corners(const HybridMesh& h, int operation) {
    const QuadMesh mesh = h.level_mesh(2);
    std::map<VertexId, int> valence;
    for (const std::int32_t v : mesh.indices) ++valence[mesh.vertex[v]];
    const auto& boundary = h.operation(operation).repatch.boundary;
    return static_cast<int>(std::count_if(boundary.begin(), boundary.end(), [&](const VertexId& v) { return valence.at(v) != 4; }));
  }
  static RemeshResult* plain_;
};
RemeshResult* PatternRegions::plain_ = nullptr;

// Around the middle of a base quad, a row of two, an angle of three, and around a corner of the cube, where three quads meet.
const std::vector<Json>& regions() {
  static const std::vector<Json> all{
      {"1.0.2", "1.1.3", "1.2.0", "1.3.1"}, {"1.0.2", "1.1.3"}, {"1.0.2", "1.1.3", "1.2.0"}, {"0.0.0", "2.0.0", "4.0.0"}};
  return all;
}

TEST_F(PatternRegions, AutomaticLayoutsKeepWhatIsAround) {
  for (const Json& quads : regions()) {
    const Json operation = {{"level", 2}, {"quads", quads}, {"layout", "automatic"}, {"buffer_rings", 1}};
    const RemeshResult made = remesh_with(Json::array({operation}));
    const HybridMesh& h = made.hierarchy;
    ASSERT_EQ(h.operation_count(), 1);
    EXPECT_EQ(h.operation(0).repatch.kind, "repatch");
    EXPECT_EQ(h.operation(0).repatch.removed.size(), quads.size());
    expect_changed_in_places(plain_->hierarchy, h, 2);
    EXPECT_EQ(irregular_corners(h, 0), 0);
    const RemeshResult again = run(ball(24), options(), made.plan);
    EXPECT_EQ(encode_hierarchy(h, "{}"), encode_hierarchy(again.hierarchy, "{}"));
    EXPECT_EQ(to_json(plan_from_json(made.plan)), to_json(plan_from_json(again.plan)));
  }
}

TEST_F(PatternRegions, TowersAreAsHighAsAskedFor) {
  // The last one has two nodes inside.
  for (const Json& quads : {Json{"1.0.2"}, Json{"1.0.2", "1.1.3"}, regions()[0], Json{"1.0.1", "1.0.2", "1.1.0", "1.1.3", "1.3.1", "1.2.0"}})
    for (const int height : {1, 3}) {
      const Json operation = {{"level", 2}, {"quads", quads}, {"layout", "cubes"}, {"height", height}, {"buffer_rings", 0}};
      const RemeshResult made = remesh_with(Json::array({operation}));
      ASSERT_EQ(made.hierarchy.operation_count(), 1);
      const HybridMesh::Operation& done = made.hierarchy.operation(0);
      EXPECT_EQ(done.repatch.kind, "add_cubes");
      EXPECT_EQ(done.roots.size(), quads.size() + height * done.repatch.boundary.size());
      expect_changed_in_places(plain_->hierarchy, made.hierarchy, 2);
    }
}

TEST_F(PatternRegions, ATowerWithoutAHeightFitsWhatSticksOut) {
  const auto cubes_on = [](const PolygonSoup& soup) {
    Json plan = cube_plan();
    plan["operations"] = Json::array({{{"level", 1}, {"quads", {"1.0", "1.1", "1.2", "1.3"}}, {"layout", "cubes"}}});
    RemeshOptions options;
    options.levels = 3;
    const RemeshResult made = run(soup, options, plan.dump());
    EXPECT_TRUE(find_defects(made.hierarchy).empty());
    const HybridMesh::Operation& done = made.hierarchy.operation(0);
    EXPECT_EQ(done.repatch.kind, "add_cubes");
    return static_cast<int>(done.roots.size() - 4) / 8;
  };
  EXPECT_EQ(cubes_on(ball(24)), 1);
  PolygonSoup horned = ball(24);
  for (Vec3& p : horned.points)
    if (p.z() > 0.8) p.z() += 8 * (p.z() - 0.8);
  EXPECT_GE(cubes_on(horned), 2);
}

TEST_F(PatternRegions, ATemplateIsWhatAnotherRegionWasGiven) {
  const std::vector<Json> operations = {{{"level", 2}, {"quads", {"1.0.2", "1.1.3"}}, {"layout", "cubes"}, {"height", 2}},
                                        {{"level", 2}, {"quads", regions()[3]}, {"layout", "automatic"}},
                                        {{"level", 2}, {"quads", {"1.0.2", "1.1.3"}}, {"layout", "automatic"}}};
  for (const Json& operation : operations) {
    const RemeshResult first = remesh_with(Json::array({operation}));
    const auto pattern = template_of(first.hierarchy, 0);
    ASSERT_TRUE(pattern);
    EXPECT_EQ(pattern->corners, 6);
    EXPECT_EQ(find_filling_defect(pattern->quads, pattern->corners), "");
    for (const Json& start : {Json{"3.0.2", 0}, Json{"3.1.3", 1}}) {
      const Json copy = {{"level", 2}, {"quads", {"3.0.2", "3.1.3"}}, {"layout", "template"}, {"start", start}, {"new_quads", pattern->quads}};
      const RemeshResult both = remesh_with(Json::array({operation, copy}));
      ASSERT_EQ(both.hierarchy.operation_count(), 2);
      expect_changed_in_places(plain_->hierarchy, both.hierarchy, 2);
      const auto copied = template_of(both.hierarchy, 1);
      ASSERT_TRUE(copied);
      EXPECT_EQ(copied->quads, pattern->quads);
    }
  }
}

TEST_F(PatternRegions, WhatDoesNotFitIsRefusedWithItsPlace) {
  const Json quads{"1.0.2", "1.1.3"};
  const Json cubes = {{"level", 2}, {"quads", quads}, {"layout", "cubes"}};
  const Json turned = {{"level", 2}, {"quads", quads}, {"layout", "template"}, {"start", {"1.0.2", 0}}, {"new_quads", {{1, 2, 3, 4}, {4, 5, 0, 1}}}};
  ASSERT_EQ(refusal_of([&] { remesh_with(Json::array({turned})); }), "");
  const auto changed = [](Json operation, const std::function<void(Json&)>& change) {
    change(operation);
    return operation;
  };
  const std::vector<std::pair<std::string, Json>> mistakes = {
      {"more than", changed(cubes, [](Json& o) { o["level"] = 12; })},
      {"one way", changed(cubes, [](Json& o) { o["curves"] = Json::array(); })},
      {"neither", changed(cubes, [](Json& o) { o.erase("layout"), o.erase("height"); })},
      {".layout", changed(cubes, [](Json& o) { o["layout"] = "spiral"; })},
      {".layout", changed(cubes, [](Json& o) { o["layout"] = 3; })},
      {".height", changed(cubes, [](Json& o) { o["height"] = -1; })},
      {".height", changed(cubes, [](Json& o) { o["height"] = "tall"; })},
      {"\"height\"", changed(cubes, [](Json& o) { o["layout"] = "automatic", o["height"] = 2; })},
      {"\"new_quads\"", changed(turned, [](Json& o) { o["layout"] = "automatic"; })},
      {"start", changed(turned, [](Json& o) { o.erase("start"); })},
      {".start[1]", changed(turned, [](Json& o) { o["start"][1] = 4; })},
      {"no quad 7.0.0", changed(turned, [](Json& o) { o["start"][0] = "7.0.0"; })},
      {"start", changed(turned,
                        [](Json& o) {
                          o["start"] = {"1.2.2", 0};
                        })},  // elsewhere
      {"start", changed(turned,
                        [](Json& o) {
                          o["start"] = {"1.0.2", 1};
                        })},  // between the two quads
      {".new_quads[1]", changed(turned,
                                [](Json& o) {
                                  o["new_quads"][1] = {4, 5, 0};
                                })},
      {".new_quads[1][3]", changed(turned, [](Json& o) { o["new_quads"][1][3] = -1; })},
      {"are none", changed(turned, [](Json& o) { o["new_quads"] = Json::array(); })},
      {"boundary of 4 sides", changed(turned,
                                      [](Json& o) {
                                        o["new_quads"] = {{0, 1, 2, 3}};
                                      })},
      {"without gaps", changed(turned,
                               [](Json& o) {
                                 o["new_quads"] = {{0, 1, 2, 7}, {2, 3, 4, 7}, {4, 5, 0, 7}};
                               })},
      {"twice", changed(turned,
                        [](Json& o) {
                          o["new_quads"] = {{0, 1, 2, 1}, {4, 5, 0, 1}};
                        })},
      {"touch itself", changed(cubes,
                               [](Json& o) {
                                 o["quads"] = {"1.0.2", "1.2.0"};
                               })},
      {"quad 1.0.2 twice", changed(cubes,
                                   [](Json& o) {
                                     o["quads"] = {"1.0.2", "1.0.2"};
                                   })},
      {"level 2 has no quad 1.0", changed(cubes, [](Json& o) { o["quads"] = {"1.0"}; })},
      {"corner 0 would have 8 quads", changed(turned,
                                              [](Json& o) {
                                                o["new_quads"] = {{0, 1, 2, 6}, {0, 6, 2, 7}, {0, 7, 2, 8}, {0, 8, 2, 3}, {0, 3, 4, 5}};
                                              })},
      {"new node 6 would have 2 quads", changed(turned,
                                                [](Json& o) {
                                                  o["new_quads"] = {{0, 1, 4, 5}, {1, 2, 3, 6}, {3, 4, 1, 6}};
                                                })},
  };
  for (const auto& mistake : mistakes) {
    const std::string& words = mistake.first;
    const Json& operation = mistake.second;  // clang captures no structured bindings
    // Its place among the operations as the plan has them.
    const Json after = {{"level", 3}, {"quads", {"5.0.0.2"}}, {"layout", "cubes"}, {"height", 1}};
    const std::string refusal = refusal_of([&] { remesh_with(Json::array({after, operation})); });
    EXPECT_NE(refusal.find("operations[1]"), std::string::npos) << operation << ": " << refusal;
    EXPECT_NE(refusal.find(words), std::string::npos) << operation << ": " << refusal;
  }
}

TEST_F(PatternRegions, TowersOnTowersAndRegionsOnTwoLevels) {
  // The first tower's cap is root quad 6 + 4. Several operations of one level leave no slivers beside each other's lines.
  const Json operations = Json::array({{{"level", 2}, {"quads", {"1.0.2"}}, {"layout", "cubes"}, {"height", 1}},
                                       {{"level", 3}, {"quads", {"10.0", "10.1", "10.2", "10.3"}}, {"layout", "cubes"}, {"height", 1}},
                                       {{"level", 3}, {"quads", {"3.0.0.2", "3.0.1.3"}}, {"layout", "automatic"}}});
  const RemeshResult made = remesh_with(operations);
  ASSERT_EQ(made.hierarchy.operation_count(), 3);
  EXPECT_TRUE(find_defects(made.hierarchy).empty());
  std::vector<std::size_t> added;
  for (int i = 0; i < 3; ++i) added.push_back(made.hierarchy.operation(i).roots.size());
  std::sort(added.begin(), added.end());
  EXPECT_EQ(added, (std::vector<std::size_t>{2, 5, 12}));
}

TEST(RegionPattern, AreJoinedOnceOnly) {
  // A ring of quads around a quad and one over it: what fills a region of two of the ring's quads must not join its corners across.
  PatchedSurface cube;
  cube.nodes = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  cube.node_count = 8;
  std::map<std::pair<int, int>, PatchSide> side;
  for (int q = 0; q < 6; ++q)
    for (int i = 0; i < 4; ++i) side[{cube.nodes[q][i], cube.nodes[q][(i + 1) % 4]}] = {q, i};
  cube.neighbours.resize(6);
  for (const auto& [ends, s] : side) cube.neighbours[s.patch][s.side] = side.at({ends.second, ends.first});
  for (const std::vector<int>& patches : {std::vector<int>{0}, {0, 2}, {0, 2, 5}, {0, 2, 4, 5}, {0, 2, 3, 4, 5}}) {
    const auto region = make_region(cube, patches);
    ASSERT_TRUE(region);
    Context context;
    const LayoutEdit edit = automatic_edit(cube, *region, Progress(context));
    EXPECT_EQ(find_filling_defect(edit.quads, static_cast<int>(region->corners.size())), "");
    EXPECT_EQ(find_edit_defect(cube, *region, edit), "");
    EXPECT_EQ(template_edit(*region, edit.quads).inner_nodes, edit.inner_nodes);
  }
  // All but two quads that meet at a corner: its chord from there is their common side.
  const auto rest = make_region(cube, {1, 3, 4, 5});
  ASSERT_TRUE(rest);
  bool refused = false;
  for (int from = 0; from < 3; ++from) refused |= find_edit_defect(cube, *rest, chord_edit(*rest, from)).find("joined") != std::string::npos;
  EXPECT_TRUE(refused);
}

}  // namespace
}  // namespace hybrid_mesh
