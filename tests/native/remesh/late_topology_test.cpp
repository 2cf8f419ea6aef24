// SPDX-License-Identifier: GPL-3.0-or-later
// Topology that is closed on the base and opens on finer levels.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "codec/container.h"
#include "generated_surfaces.h"
#include "handled_surfaces.h"
#include "remesh/plans.h"
#include "remesh/soundness.h"
#include "surface/placement.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::expect_maps_without_defects;
using testing::expect_sound;
using testing::Json;
using testing::refusal_of;
using testing::run;
using testing::torus;

RemeshOptions late(std::int64_t vertices, Refinement refinement = Refinement::Uniform) {
  RemeshOptions options;
  options.vertices = vertices;
  options.base = BaseSize::Minimal;
  options.refinement = refinement;
  return options;
}

std::vector<std::uint8_t> bytes_of(const RemeshResult& r) { return encode_hierarchy(r.hierarchy, "{}"); }

std::vector<TopologySummary> level_topologies(const RemeshResult& r) {
  std::vector<TopologySummary> out;
  for (int j = 0; j <= r.hierarchy.depth(); ++j) out.push_back(summarize_topology(to_soup(r.hierarchy.level_mesh(j))));
  return out;
}

// Every level is a manifold with the topology that the report says is open by then.
void expect_levels_as_reported(const RemeshResult& r) {
  const std::vector<TopologySummary> levels = level_topologies(r);
  const TopologySummary input = summarize_topology(to_soup(r.repaired));
  const Json& topology = r.report["topology"];
  for (std::size_t j = 0; j < levels.size(); ++j) {
    const auto closed = [&](const char* what) {
      int count = 0;
      for (const Json& e : topology[what]) count += e["level"].get<int>() > static_cast<int>(j);
      return count;
    };
    const TopologySummary& t = levels[j];
    EXPECT_EQ(t.nonmanifold_edges + t.nonmanifold_vertices + t.misoriented_edges, 0) << "level " << j;
    EXPECT_EQ(t.genus, input.genus - closed("loops")) << "level " << j;
    EXPECT_EQ(t.components, input.components - closed("tubes")) << "level " << j;
    EXPECT_EQ(t.boundary_loops, input.boundary_loops - closed("boundaries")) << "level " << j;
    EXPECT_EQ(r.report["levels"][j]["genus"].get<double>(), t.genus) << "level " << j;
  }
}

// Every point of a map lies where its source says, on a face of the repaired surface, unless it is on what is closed there.
void expect_sources_on_the_surface(const RemeshResult& r) {
  const HybridMesh& h = r.hierarchy;
  const double diagonal = placement_of(r.repaired.points).diagonal;
  for (const int leaf : h.leaves()) {
    const PatchMap& map = *h.map(h.map_owner(leaf));
    for (std::size_t t = 0; t < map.triangles.size(); ++t) {
      ASSERT_GE(map.source_face[t], 0);
      ASSERT_LT(map.source_face[t], static_cast<int>(r.repaired.faces.size()));
      for (int c = 0; c < 3; ++c) {
        Vec3 p = Vec3::Zero();
        for (int i = 0; i < 3; ++i) p += map.source[t][3 * c + i] * r.repaired.points[r.repaired.faces[map.source_face[t]][i]];
        EXPECT_LT((p - map.positions[map.triangles[t][c]]).norm(), 1e-4 * diagonal);
      }
    }
  }
}

PolygonSoup two_balls() {
  PolygonSoup all = ball(12);
  const PolygonSoup other = ball(10, 2, Vec3(2.6, 0.2, 0.1), 0.8);
  const auto first = static_cast<std::int32_t>(all.points.size());
  all.points.insert(all.points.end(), other.points.begin(), other.points.end());
  for (const std::int32_t i : other.indices) all.indices.push_back(first + i);
  for (std::size_t f = 1; f < other.offsets.size(); ++f) all.offsets.push_back(all.offsets.back() + other.offsets[f] - other.offsets[f - 1]);
  return all;
}

TEST(LateTopology, ATorusBeginsAsABall) {
  const RemeshResult r = run(torus(48, 24), late(3000));
  expect_sound(r);
  expect_maps_without_defects(r.hierarchy);
  expect_levels_as_reported(r);
  expect_sources_on_the_surface(r);
  EXPECT_EQ(level_topologies(r).front().genus, 0);
  EXPECT_LE(r.report["base"]["quads"].get<int>(), 18);
  ASSERT_EQ(r.report["topology"]["loops"].size(), 1u);
  EXPECT_GT(r.report["topology"]["loops"][0]["level"].get<int>(), 0);
}

TEST(LateTopology, ThePlanOpensItAgain) {
  const PolygonSoup soup = torus(48, 24);
  const RemeshOptions options = late(3000);
  const RemeshResult first = run(soup, options);
  const RemeshResult again = run(soup, options, first.plan);
  EXPECT_EQ(again.report["topology"], first.report["topology"]);
  EXPECT_EQ(bytes_of(again), bytes_of(first));
  EXPECT_EQ(again.plan, first.plan);
  // Its loops alone, on another resolution.
  const Json plan = Json::parse(first.plan);
  const Json loops{{"format", plan["format"]}, {"version", plan["version"]}, {"topology", plan["topology"]}};
  const RemeshResult finer = run(torus(72, 36), options, loops.dump());
  expect_sound(finer);
  expect_levels_as_reported(finer);
  EXPECT_EQ(level_topologies(finer).front().genus, 0);
}

TEST(LateTopology, LevelsThatAPlanGives) {
  const PolygonSoup soup = torus(48, 24);
  const RemeshOptions options = late(3000);
  const int usual = run(soup, options).report["topology"]["loops"][0]["level"].get<int>();
  Json plan = Json::parse(run(soup, options).plan);
  const Json topology = plan["topology"];
  plan = {{"format", plan["format"]}, {"version", plan["version"]}, {"topology", topology}};
  plan["topology"][0]["level"] = usual + 1;
  const RemeshResult r = run(soup, options, plan.dump());
  EXPECT_EQ(r.report["topology"]["loops"][0]["level"].get<int>(), usual + 1);
  expect_sound(r);
  expect_levels_as_reported(r);
  // One without room: then it opens on the next that has, and the report says why.
  plan["topology"][0]["level"] = 1;
  const RemeshResult later = run(soup, options, plan.dump());
  const Json& loop = later.report["topology"]["loops"][0];
  EXPECT_GT(loop["level"].get<int>(), 1);
  EXPECT_FALSE(loop.value("reason", "").empty());
  // A level that the mesh does not have: then the base has the handle, and the report says so.
  plan["topology"][0]["level"] = 9;
  const RemeshResult none = run(soup, options, plan.dump());
  expect_sound(none);
  EXPECT_EQ(level_topologies(none).front().genus, 1);
  EXPECT_EQ(none.report["topology"]["loops"][0]["level"].get<int>(), 0);
  EXPECT_GT(none.report["topology"]["loops"][0]["length"].get<double>(), 0);
  EXPECT_FALSE(none.report["topology"]["loops"][0]["reason"].get<std::string>().empty());
  for (const Json& bad :
       {Json{{"kind", "cutting"}, {"loops", topology[0]["loops"]}}, Json{{"kind", "tube"}, {"loops", topology[0]["loops"]}},
        Json{{"kind", "cut"}, {"loops", {{{0, 0, 0}, {1, 0, 0}}}}}, Json{{"kind", "cut"}, {"loops", topology[0]["loops"]}, {"level", 0}}}) {
    plan["topology"] = Json::array({bad});
    EXPECT_NE(refusal_of([&] { run(soup, options, plan.dump()); }).find("topology[0]"), std::string::npos) << bad;
  }
}

TEST(LateTopology, AnAdaptiveMeshIsFineOnlyWhereItNeedsToBe) {
  const RemeshResult r = run(torus(96, 48), late(2500, Refinement::Adaptive));
  expect_sound(r);
  expect_levels_as_reported(r);
  EXPECT_GT(static_cast<double>(r.final_mesh.points.size()), 0.97 * 2500);
}

TEST(LateTopology, SemiRegularMeshesAndBasesHaveAllOfIt) {
  RemeshOptions options = late(2000);
  options.topology = TopologyMode::Base;
  const RemeshResult r = run(torus(48, 24), options);
  expect_sound(r);
  EXPECT_EQ(level_topologies(r).front().genus, 1);
  EXPECT_TRUE(r.report["topology"]["loops"].empty());
}

TEST(LateTopology, ComponentsPartOnAFinerLevel) {
  RemeshOptions options = late(3000);
  options.components = Components::Joined;
  const PolygonSoup two = two_balls();
  const RemeshResult r = run(two, options);
  expect_sound(r);
  expect_maps_without_defects(r.hierarchy);
  expect_levels_as_reported(r);
  expect_sources_on_the_surface(r);
  EXPECT_EQ(level_topologies(r).front().components, 1);
  EXPECT_EQ(level_topologies(r).back().components, 2);
}

// Many joints take quads of fine levels, more than a small mesh may have: then some are in the base.
TEST(LateTopology, TheBoundOnVerticesHoldsWhateverOpens) {
  PolygonSoup balls;
  for (int i = 0; i < 8; ++i) {
    const int column = i % 4, row = i / 4;
    testing::add(balls, ball(8, 2, Vec3(2.3 * column, 2.3 * row, 0.1 * i), 0.7 + 0.05 * i));
  }
  for (const std::int64_t vertices : {700, 1500}) {
    RemeshOptions options = late(vertices, Refinement::Adaptive);
    options.components = Components::Joined;
    const RemeshResult r = run(balls, options);
    expect_sound(r);
    expect_levels_as_reported(r);
    EXPECT_LE(static_cast<std::int64_t>(r.final_mesh.points.size()), vertices);
    EXPECT_EQ(level_topologies(r).back().components, 8);
  }
}

TEST(LateTopology, OpensOnTheLastLevelAtLatest) {
  for (const Refinement refinement : {Refinement::Uniform, Refinement::Adaptive})
    for (const int levels : {1, 2, 3}) {
      RemeshOptions options = late(20000, refinement);
      options.levels = levels;
      const RemeshResult r = run(torus(60, 30), options);
      expect_sound(r);
      expect_levels_as_reported(r);
      EXPECT_LE(r.hierarchy.depth(), levels);
      EXPECT_EQ(r.report["final"]["genus"], 1);
    }
}

TEST(LateTopology, BoundariesOpenOnAFinerLevel) {
  const PolygonSoup open = ball(16, 0.7);
  const RemeshResult r = run(open, late(3000));
  expect_sound(r);
  expect_levels_as_reported(r);
  expect_sources_on_the_surface(r);
  EXPECT_EQ(level_topologies(r).front().boundary_loops, 0);
  EXPECT_EQ(level_topologies(r).back().boundary_loops, 1);
}

TEST(LateTopology, NoiseIsClosedForGood) {
  const TriangleSurface noisy = testing::noisy_ball(12, 3);
  RemeshOptions options = late(2000);
  options.remove_noise = 0.15;
  const RemeshResult r = run(to_soup(noisy), options);
  EXPECT_EQ(r.report["topology"]["removed_handles"].get<int>(), 3);
  EXPECT_EQ(summarize_topology(to_soup(r.final_mesh)).genus, 0);
  for (const int f : r.repaired.source_face) EXPECT_GE(f, 0);
  options.remove_noise = 0;
  const RemeshResult all = run(to_soup(noisy), options);
  expect_sound(all);
  EXPECT_EQ(summarize_topology(to_soup(all.final_mesh)).genus, 3);
  expect_levels_as_reported(all);
}

// Caps a few triangles wide, side by side: no quads are small enough to come between them.
TEST(LateTopology, SidesThatHaveNoRoomBesideEachOtherOpenAsOne) {
  const RemeshResult r = run(to_soup(testing::noisy_ball(12, 4)), late(4000, Refinement::Adaptive));
  expect_sound(r);
  expect_levels_as_reported(r);
  EXPECT_EQ(level_topologies(r).front().genus, 0) << r.report["topology"];
  EXPECT_EQ(level_topologies(r).back().genus, 4);
}

TEST(LateTopology, AsManyBoundariesAsTheSurfaceHas) {
  int holes = 0;
  const PolygonSoup soup = testing::ball_with_holes(16, holes);
  ASSERT_GT(holes, 24);
  for (const std::int64_t vertices : {1500, 12000}) {
    const RemeshResult r = run(soup, late(vertices, Refinement::Adaptive));
    expect_sound(r);
    expect_levels_as_reported(r);
    EXPECT_EQ(level_topologies(r).front().boundary_loops, 0);
    EXPECT_EQ(level_topologies(r).back().boundary_loops, holes);
  }
}

// A level lies on the surface with what has not opened closed, wherever that stands.
TEST(LateTopology, LevelsAreMeasuredToTheirOwnSurface) {
  PolygonSoup moved = torus(48, 24);
  for (Vec3& p : moved.points) p = 100 * p + Vec3(300, -200, 50);
  for (const PolygonSoup& soup : {torus(48, 24), moved}) {
    const RemeshResult r = run(soup, late(3000));
    const int opens = r.report["topology"]["loops"][0]["level"].get<int>();
    for (const Json& level : r.report["levels"]) {
      if (level["level"].get<int>() >= opens) {
        EXPECT_TRUE(level["closed_surface"].is_null());
      } else {
        // The input has no caps, and the mesh has.
        EXPECT_LT(level["closed_surface"]["l2"].get<double>(), level["l2"].get<double>());
        EXPECT_LT(level["closed_surface"]["hausdorff"].get<double>(), 0.2);
      }
    }
  }
}

PolygonSoup moved(PolygonSoup soup, const Eigen::Isometry3d& by) {
  for (Vec3& p : soup.points) p = by * p;
  return soup;
}

// Whatever hangs together in whatever way: the right topology on every level, and what finds no room is in the base and said to be.
TEST(LateTopology, HardCases) {
  using Eigen::AngleAxisd;
  using Eigen::Isometry3d;
  using Eigen::Translation3d;
  std::vector<std::pair<std::string, PolygonSoup>> cases;
  cases.push_back({"a chain of twelve rings", testing::plate_with_windows(12, 3)});
  PolygonSoup linked = torus(32, 16, 0.25);
  testing::add(linked, moved(torus(32, 16, 0.25), Translation3d(1, 0, 0) * Isometry3d(AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()))));
  cases.push_back({"two rings, each through the other", linked});
  PolygonSoup nested = torus(40, 20, 0.45);
  testing::add(nested, torus(40, 12, 0.2));
  cases.push_back({"a ring inside a ring", nested});
  PolygonSoup threaded = torus(40, 20, 0.3);
  for (const double at : {-0.3, 0.3})
    testing::add(threaded, moved(torus(32, 12, 0.12), Translation3d(1, at, 0) * Isometry3d(AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()))));
  cases.push_back({"two rings through one", threaded});
  for (const auto& [name, soup] : cases) {
    SCOPED_TRACE(name);
    RemeshOptions options = late(5000, Refinement::Adaptive);
    options.components = Components::Joined;
    const RemeshResult r = run(soup, options);
    expect_sound(r);
    expect_levels_as_reported(r);
    EXPECT_LE(r.final_mesh.points.size(), 5000u);
    for (const char* what : {"loops", "tubes"})
      for (const Json& e : r.report["topology"][what]) EXPECT_TRUE(e["level"].get<int>() > 0 || !e.value("reason", "").empty()) << e;
  }
}

TEST(LateTopology, AChainOfFiftyRings) {
  const RemeshResult r = run(testing::plate_with_windows(50, 3), late(16000, Refinement::Adaptive));
  expect_sound(r);
  expect_levels_as_reported(r);
  EXPECT_LE(r.final_mesh.points.size(), 16000u);
  const Json& loops = r.report["topology"]["loops"];
  EXPECT_EQ(loops.size(), 50u);
  for (const Json& e : loops) EXPECT_TRUE(e["level"].get<int>() > 0 || !e.value("reason", "").empty()) << e;
}

TEST(LateTopology, TheSameBytesForAnyNumberOfThreads) {
  RemeshOptions options = late(2000, Refinement::Adaptive);
  options.threads = 1;
  const auto one = bytes_of(run(torus(48, 24), options));
  options.threads = 3;
  EXPECT_EQ(bytes_of(run(torus(48, 24), options)), one);
}

}  // namespace
}  // namespace hybrid_mesh
