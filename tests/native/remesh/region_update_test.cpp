// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/region_update.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "codec/container.h"
#include "remesh/plans.h"
#include "surface/distance.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::cube_plan;
using testing::expect_changed_in_places;
using testing::Json;
using testing::refusal_of;
using testing::run;

RegionUpdate update(const HybridMesh& h, const std::vector<int>& roots, const Json& operation) {
  Context context;
  return repatch_hierarchy(h, roots, plan_region_from_json(operation.dump()), Progress(context));
}

Json operation_on(const Json& quads, int rings = 1) { return {{"level", 2}, {"quads", quads}, {"layout", "automatic"}, {"buffer_rings", rings}}; }
const Json& middle_of_a_base_quad() {
  static const Json quads{"1.0.2", "1.1.3", "1.2.0", "1.3.1"};
  return quads;
}

// A ball in six quads, far from the origin and not of unit size.
class RegionUpdates : public ::testing::Test {
 protected:
  static PolygonSoup soup() {
    PolygonSoup soup = ball(24);
    for (Vec3& p : soup.points) p = 30 * p + Vec3(100, -50, 7);
    return soup;
  }
  static Json plan() {
    Json plan = cube_plan();
    for (Json& p : plan["base"]["nodes"])
      for (int i = 0; i < 3; ++i) p[i] = 30 * p[i].get<double>() + (i == 0 ? 100 : i == 1 ? -50 : 7);
    return plan;
  }
  static RemeshOptions options() {
    RemeshOptions options;
    options.levels = 4;
    return options;
  }
  static void SetUpTestSuite() { plain_ = new RemeshResult(run(soup(), options(), plan().dump())); }
  static void TearDownTestSuite() {
    delete plain_;
    plain_ = nullptr;
  }
  static RemeshResult* plain_;
};
RemeshResult* RegionUpdates::plain_ = nullptr;

std::map<VertexId, Vec3> points_of(const QuadMesh& mesh) {
  std::map<VertexId, Vec3> at;
  for (std::size_t v = 0; v < mesh.vertex.size(); ++v) at[mesh.vertex[v]] = mesh.points[v];
  return at;
}

// The root mean square, as a fraction of the diagonal.
double distance_to(const PolygonSoup& source, const QuadMesh& mesh) {
  Context context;
  return DistanceReference(source).distance(to_soup(mesh), DistanceOptions(), Progress(context)).l2;
}

TEST_F(RegionUpdates, WhatLiesFartherOffStaysToTheLastDigit) {
  const HybridMesh& before = plain_->hierarchy;
  for (const int rings : {0, 1, 2}) {
    const RegionUpdate made = update(before, plain_->plan_root, operation_on(middle_of_a_base_quad(), rings));
    const HybridMesh& h = made.hierarchy;
    ASSERT_EQ(h.operation_count(), 1);
    EXPECT_EQ(made.operation, 0);
    const int own = expect_changed_in_places(before, h, 2);
    EXPECT_EQ(h.depth(), before.depth());
    EXPECT_TRUE(h.conforming());
    // Which nodes have new maps, and what is under them.
    std::vector<char> fresh(h.node_count(), 0);
    int mapped = 0;
    for (int n = 0; n < h.node_count(); ++n) {
      const bool new_map = h.map(n) && (n >= before.node_count() || h.map(n) != before.map(n));
      mapped += new_map;
      fresh[n] = new_map || (!h.is_root(n) && fresh[h.parent(n)]);
    }
    EXPECT_EQ(mapped, own);
    for (int j = 0; j <= h.depth(); ++j) {
      const QuadMesh mesh = h.level_mesh(j);
      const auto was = points_of(before.level_mesh(j));
      std::vector<char> only_fresh(mesh.points.size(), 1);
      for (std::size_t f = 0; f < mesh.face_count(); ++f)
        for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) only_fresh[mesh.indices[i]] &= fresh[mesh.node[f]];
      int same = 0;
      for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        if (only_fresh[v]) continue;
        EXPECT_EQ(mesh.points[v], was.at(mesh.vertex[v]));
        ++same;
      }
      EXPECT_GT(same, j == 0 ? 7 : 20);
      if (j < 2) {
        EXPECT_EQ(static_cast<std::size_t>(same), mesh.points.size());
      }
    }
    EXPECT_EQ(points_of(h.final_mesh()), points_of(h.level_mesh(h.depth())));
    // The finest level is as near to the surface as it was.
    const double was = distance_to(soup(), before.final_mesh()), is = distance_to(soup(), h.final_mesh());
    EXPECT_LT(is, 1.2 * was) << rings;
  }
}

TEST_F(RegionUpdates, APlanAndAnUpdateLayOutTheSameQuads) {
  for (const Json& quads : {middle_of_a_base_quad(), Json{"1.0.2", "1.1.3"}, Json{"0.0.0", "2.0.0", "4.0.0"}}) {
    Json with = plan();
    with["operations"] = Json::array({operation_on(quads)});
    const RemeshResult planned = run(soup(), options(), with.dump());
    const RegionUpdate made = update(plain_->hierarchy, plain_->plan_root, operation_on(quads));
    const HybridMesh &a = planned.hierarchy, &b = made.hierarchy;
    ASSERT_EQ(a.operation_count(), 1);
    EXPECT_EQ(a.operation(0).repatch.removed, b.operation(0).repatch.removed);
    EXPECT_EQ(a.operation(0).repatch.quads, b.operation(0).repatch.quads);
    EXPECT_EQ(planned.plan_root.size() <= made.root_numbers.size(), true);
    for (std::size_t k = 0; k < a.operation(0).roots.size(); ++k) {
      const int x = a.operation(0).roots[k], y = b.operation(0).roots[k];
      EXPECT_EQ(planned.plan_root[x], made.root_numbers[y]);
      // The map is found by descent on triangles that are cut a little differently: alike to a hundredth of a quad's width.
      for (const double u : {0.1, 0.5, 0.9}) EXPECT_NEAR((a.sample({x, u, 0.3}).position - b.sample({y, u, 0.3}).position).norm(), 0, 1e-4 * 60);
    }
  }
}

TEST_F(RegionUpdates, FollowOneAnother) {
  HybridMesh h = plain_->hierarchy;
  std::vector<int> roots = plain_->plan_root;
  // The second one's quads lie in the ring around the first; the third is on a finer level, on quads that the first put in.
  for (const Json& operation : {operation_on(middle_of_a_base_quad()), operation_on({"1.0.1", "1.1.0"}),
                                Json{{"level", 3}, {"quads", {"6.0", "6.1", "6.2", "6.3"}}, {"layout", "cubes"}, {"height", 1}}}) {
    RegionUpdate made = update(h, roots, operation);
    h = std::move(made.hierarchy);
    roots = std::move(made.root_numbers);
    EXPECT_TRUE(find_defects(h).empty());
    for (int n = 0; n < h.node_count(); ++n)
      if (h.map(n)) {
        EXPECT_STREQ(find_map_defect(*h.map(n)), "");
      }
  }
  EXPECT_EQ(h.operation_count(), 3);
  // A file keeps it: work goes on where it stopped.
  const std::vector<std::uint8_t> bytes = encode_hierarchy(h, "{}");
  EXPECT_EQ(decode_hierarchy(bytes.data(), bytes.size()).hierarchy.operation_count(), 3);
}

TEST_F(RegionUpdates, AdaptiveHierarchiesKeepTheirQuads) {
  RemeshOptions options;
  options.refinement = Refinement::Adaptive;
  options.vertices = 1500;
  const RemeshResult plain = run(testing::spiked_ball(30), options, cube_plan().dump());
  const RegionUpdate made = update(plain.hierarchy, plain.plan_root, operation_on(middle_of_a_base_quad()));
  EXPECT_TRUE(find_defects(made.hierarchy).empty());
  EXPECT_EQ(summarize_topology(to_soup(made.hierarchy.final_mesh())).euler, 2);
  EXPECT_EQ(made.hierarchy.operation_count(), 1);
  const auto faces = static_cast<double>(plain.hierarchy.final_mesh().face_count());
  EXPECT_NEAR(static_cast<double>(made.hierarchy.final_mesh().face_count()), faces, 0.25 * faces);
}

TEST_F(RegionUpdates, SayWhyTheyCannotBeDone) {
  const auto refusal = [](const HybridMesh& h, const std::vector<int>& roots, const Json& operation) {
    return refusal_of([&] { update(h, roots, operation); });
  };
  const HybridMesh& h = plain_->hierarchy;
  const std::vector<int>& roots = plain_->plan_root;
  EXPECT_NE(refusal(h, roots, operation_on({"9.0.1"})).find("has no quad 9.0.1"), std::string::npos);
  EXPECT_NE(refusal(h, roots, operation_on({"1.0.2", "1.2.0"})).find("touch itself"), std::string::npos);
  Json deep = operation_on({"1.0.0.0.0.0"});
  deep["level"] = 5;
  EXPECT_NE(refusal(h, roots, deep).find("has no level 5"), std::string::npos);
  const RegionUpdate made = update(h, roots, operation_on(middle_of_a_base_quad()));
  EXPECT_NE(refusal(made.hierarchy, made.root_numbers, operation_on({"6"})).find("was put in by another operation"), std::string::npos);
  Json coarse = operation_on({"2.0"});
  coarse["level"] = 1;
  EXPECT_NE(refusal(made.hierarchy, made.root_numbers, coarse).find("level 2 has operations already"), std::string::npos);
  HybridMesh bare = h;
  bare.drop_maps();
  EXPECT_NE(refusal(bare, roots, operation_on(middle_of_a_base_quad())).find("no maps"), std::string::npos);
  Context cancelled;
  cancelled.cancel();
  EXPECT_THROW(repatch_hierarchy(h, roots, plan_region_from_json(operation_on(middle_of_a_base_quad()).dump()), Progress(cancelled)), Error);
}

}  // namespace
}  // namespace hybrid_mesh
