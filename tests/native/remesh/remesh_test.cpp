// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/remesh.h"

#include <gtest/gtest.h>

#include <set>
#include <thread>

#include "codec/container.h"
#include "generated_surfaces.h"
#include "models.h"
#include "remesh/fit.h"
#include "shapes.h"
#include "soundness.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::torus;

RemeshResult run(const PolygonSoup& soup, std::int64_t vertices, Refinement refinement, int threads = 0) {
  RemeshOptions options;
  options.vertices = vertices;
  options.refinement = refinement;
  options.threads = threads;
  Context context;
  RemeshResult r = remesh(soup, options, context);
  EXPECT_EQ(context.progress(), 1);
  return r;
}

void expect_good(const RemeshResult& r, std::int64_t vertices) {
  testing::expect_sound(r);
  const std::int64_t made = static_cast<std::int64_t>(r.final_mesh.points.size());
  EXPECT_LE(made, vertices);
  EXPECT_GE(made, 0.98 * vertices);
  for (std::size_t f = 0; f < r.final_mesh.face_count(); ++f) ASSERT_EQ(r.final_mesh.offsets[f + 1] - r.final_mesh.offsets[f], 4);
  EXPECT_LE(r.report["final"]["hausdorff"].get<double>(), 0.01);
  EXPECT_EQ(r.report["final"]["vertices"].get<std::int64_t>(), made);
  EXPECT_EQ(r.report["levels"].size(), static_cast<std::size_t>(r.hierarchy.depth() + 1));
}

class RemeshKinds : public ::testing::TestWithParam<Refinement> {};
INSTANTIATE_TEST_SUITE_P(Refinements, RemeshKinds, ::testing::Values(Refinement::Uniform, Refinement::Adaptive));

TEST_P(RemeshKinds, KeepTopologyBudgetAndShape) {
  PolygonSoup several = ball(16);
  testing::add(several, ball(14, 0.5, Vec3(3, 0, 0), 0.8));
  testing::add(several, torus(40, 20));
  for (const PolygonSoup& soup : {ball(20), ball(20, 0.5), torus(60, 30), several}) expect_good(run(soup, 3000, GetParam()), 3000);
}

TEST_P(RemeshKinds, SameBytesWhateverTheThreadsAndTheRun) {
  const PolygonSoup soup = torus(50, 25);
  const auto bytes = [&](int threads) { return encode_hierarchy(run(soup, 2000, GetParam(), threads).hierarchy, "{}"); };
  const auto first = bytes(1);
  EXPECT_EQ(first, bytes(2));
  EXPECT_EQ(first, bytes(1));
}

TEST_P(RemeshKinds, AreAsGoodFarAwayAndAtAnyScale) {
  const PolygonSoup soup = ball(20);
  const double l2 = run(soup, 2000, GetParam()).report["final"]["l2"].get<double>();
  for (const auto& [shift, scale] : {std::pair(2000.0, 1.0), std::pair(0.0, 1e-3), std::pair(0.0, 1e3)}) {
    PolygonSoup moved = soup;
    for (Vec3& p : moved.points) p = scale * p + Vec3(shift, -shift, shift);
    const RemeshResult r = run(moved, 2000, GetParam());
    expect_good(r, 2000);
    EXPECT_NEAR(r.report["final"]["l2"].get<double>(), l2, 0.25 * l2);
  }
}

// Bodies of few triangles beside one another: their base would be pillows of two quads, whose corners are the same.
TEST(Remesh, SmallBodiesHaveTheQuadsOfACube) {
  PolygonSoup soup;
  for (int k = 0; k < 40; ++k) {
    PolygonSoup body = k % 2 == 0 ? testing::ball(4) : cube();
    const Vec3 size(1, 0.2 + 0.02 * k, k % 3 == 0 ? 0.05 : 0.6);
    const int column = k % 8, row = k / 8;
    for (Vec3& p : body.points) p = p.cwiseProduct(size) + Vec3(3 * column, 3 * row, 0);
    append(soup, body);
  }
  RemeshOptions options;
  options.vertices = 2500;
  Context context;
  const RemeshResult r = remesh(soup, options, context);
  const QuadMesh base = r.hierarchy.level_mesh(0);
  EXPECT_GE(base.face_count(), 40U * 6);
  std::set<std::set<int>> corners;
  for (std::size_t f = 0; f < base.face_count(); ++f)
    EXPECT_TRUE(corners.insert({base.indices.begin() + base.offsets[f], base.indices.begin() + base.offsets[f + 1]}).second);
}

TEST(Remesh, ABaseThatTakesAllVerticesIsRefusedByName) {
  PolygonSoup soup;
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 38; ++column) append(soup, cube(Vec3(3 * column, 3 * row, 0)));
  RemeshOptions options;
  options.vertices = 8000;
  options.features = Features::None;
  Context context;
  try {
    remesh(soup, options, context);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::InvalidInput);
    for (const char* part : {"760 components", "8000 vertices", "drop_components"})
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
  }
}

// Scans have crumbs beside them. What a cube's quads are cut into needs more triangles than a crumb has.
TEST_P(RemeshKinds, KeepCrumbsOfAFewTriangles) {
  PolygonSoup soup = ball(20);
  const auto add = [&](const Vec3& at, double size, const std::vector<std::array<int, 3>>& faces) {
    const int first = static_cast<int>(soup.points.size());
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.3, 0.3, 0.2), Vec3(0.3, 0.3, -0.7)})
      soup.points.push_back(at + size * p);
    for (const auto& f : faces) {
      for (const int v : f) soup.indices.push_back(first + v);
      soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
    }
  };
  add(Vec3(1.5, 0, 0), 0.02, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  add(Vec3(0, 1.5, 0), 0.05, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}});
  for (const BaseSize base : {BaseSize::Auto, BaseSize::Minimal}) {
    RemeshOptions options;
    options.vertices = 3000;
    options.refinement = GetParam();
    options.base = base;
    Context context;
    const RemeshResult made = remesh(soup, options, context);
    EXPECT_TRUE(find_defects(made.hierarchy).empty());
    for (int level = 0; level <= made.hierarchy.depth(); ++level) {
      const TopologySummary t = summarize_topology(to_soup(made.hierarchy.level_mesh(level)));
      EXPECT_EQ(t.components, 3);
      EXPECT_EQ(t.genus, 0);
      EXPECT_EQ(t.nonmanifold_edges + t.nonmanifold_vertices + t.misoriented_edges, 0);
    }
    if (base == BaseSize::Minimal) {
      EXPECT_EQ(made.hierarchy.base_count(), 18);
    }
  }
}

// A ball with two spikes, of which a cube's quads have no skin to cover.
PolygonSoup spiked_ball(int n) {
  PolygonSoup soup = ball(n);
  for (Vec3& p : soup.points) {
    const double r = p.norm(), z = p.z() / r, x = p.x() / r;
    if (z > 0.9) p.z() += 30 * (z - 0.9) * r;
    if (x > 0.9) p.x() += 24 * (x - 0.9) * r;
  }
  return soup;
}

RemeshOptions from_a_cube(std::int64_t vertices, Refinement refinement) {
  RemeshOptions options;
  options.vertices = vertices;
  options.refinement = refinement;
  options.base = BaseSize::Minimal;
  return options;
}

RemeshResult run(const PolygonSoup& soup, const RemeshOptions& options) {
  Context context;
  return remesh(soup, options, context);
}

TEST_P(RemeshKinds, GrowSkinWithinTheHierarchyOfACube) {
  const PolygonSoup soup = spiked_ball(40);
  RemeshOptions options = from_a_cube(4000, GetParam());
  const RemeshResult hybrid = run(soup, options);
  EXPECT_TRUE(find_defects(hybrid.hierarchy).empty());
  EXPECT_EQ(hybrid.hierarchy.base_count(), 6);
  ASSERT_GT(hybrid.hierarchy.operation_count(), 0);
  const auto& report = hybrid.report;
  std::int64_t inserted = 6;
  int reported = 0;
  for (const auto& level : report["levels"])
    for (const auto& op : level["irregular_ops"]) {
      ++reported;
      inserted += op["new_quads"].get<std::int64_t>();
      EXPECT_GT(op["removed_quads"].get<int>(), 0);
    }
  EXPECT_EQ(reported, hybrid.hierarchy.operation_count());
  // Of the quads that are not where sizes meet.
  std::int64_t regular = 0;
  for (const int node : hybrid.final_mesh.node) {
    bool transition = false;
    for (int side = 0; side < 4; ++side) transition |= hybrid.hierarchy.leaf_neighbours(node, side).size() > 1;
    regular += !transition;
  }
  EXPECT_NEAR(report["final"]["regular_fraction"].get<double>(), 1 - static_cast<double>(inserted) / static_cast<double>(regular), 1e-12);
  EXPECT_GT(report["final"]["irregular_vertices"]["operations"].get<int>(), 0);
  if (GetParam() == Refinement::Uniform) {
    EXPECT_EQ(report["final"]["irregular_vertices"]["transitions"].get<int>(), 0);
  }
  // Every level is a ball, before its operations and after.
  for (int j = 0; j <= hybrid.hierarchy.depth(); ++j)
    for (const LevelKind kind : {LevelKind::M, LevelKind::N}) {
      const QuadMesh mesh = hybrid.hierarchy.level_mesh(j, kind);
      const TopologySummary t = summarize_topology(to_soup(mesh));
      EXPECT_EQ(t.nonmanifold_edges + t.nonmanifold_vertices + t.misoriented_edges, 0);
      EXPECT_EQ(t.euler, 2);
      EXPECT_EQ(t.components, 1);
      for (const Vec3& p : mesh.points) EXPECT_TRUE(p.allFinite());
    }
  EXPECT_EQ(encode_hierarchy(hybrid.hierarchy, "{}"), encode_hierarchy(run(soup, options).hierarchy, "{}"));
  // Beside the semi-regular mesh of the nearest size: of the cube's levels that is the one with 6146 vertices.
  options.semi_regular = true;
  if (GetParam() == Refinement::Uniform) options.vertices = 6146;
  const RemeshResult plain = run(soup, options);
  EXPECT_EQ(plain.hierarchy.operation_count(), 0);
  const auto q = [](const RemeshResult& r) { return r.report["final"]["l2"].get<double>() * r.report["final"]["vertices"].get<double>(); };
  const auto jacobian = [](const RemeshResult& r) { return r.report["final"]["scaled_jacobian"]["p05"].get<double>(); };
  const auto stretch = [](const RemeshResult& r) {
    const auto& of = r.report["levels"].back()["stretch"];
    return of["p95"].get<double>() / of["p05"].get<double>();
  };
  EXPECT_GT(jacobian(hybrid), jacobian(plain));
  EXPECT_LT(stretch(hybrid), stretch(plain));
  // Adaptive refinement makes up for stretched quads by their number.
  if (GetParam() == Refinement::Uniform) {
    EXPECT_LT(q(hybrid), q(plain));
  }
}

TEST(Remesh, GrowsTowersOnAFittedBaseWhereTheStretchAsksForThem) {
  const PolygonSoup soup = spiked_ball(40);
  RemeshOptions options;
  options.vertices = 2030;  // a base of 31 quads leaves room for two rings on the level of the operations
  options.levels = 3;       // so few base quads that they cannot follow both spikes
  RemeshResult plain, grown;
  // Where near-ties leave the stretch to many quads alike, turned sides are tried first, and none is better.
  for (options.seed = 1; options.seed <= 6 && grown.hierarchy.operation_count() == 0; ++options.seed) {
    options.stretch_threshold = 1e3;
    plain = run(soup, options);
    EXPECT_EQ(plain.hierarchy.operation_count(), 0);
    options.stretch_threshold = 1.5;
    grown = run(soup, options);
  }
  --options.seed;
  const auto largest = [](const RemeshResult& r) { return r.report["levels"][2]["stretch"]["max"].get<double>(); };
  ASSERT_GT(largest(plain), options.stretch_threshold);
  EXPECT_TRUE(find_defects(grown.hierarchy).empty());
  ASSERT_GT(grown.hierarchy.operation_count(), 0);
  for (int i = 0; i < grown.hierarchy.operation_count(); ++i) EXPECT_EQ(grown.hierarchy.operation(i).repatch.level, 2);
  EXPECT_LT(largest(grown), largest(plain));
  EXPECT_EQ(grown.hierarchy.depth(), 3);
  // The budget holds, and what was decided can be made again.
  EXPECT_LE(grown.final_mesh.points.size(), 2030u);
  RemeshOptions again = options;
  again.plan = grown.plan;
  EXPECT_EQ(encode_hierarchy(run(soup, again).hierarchy, "{}"), encode_hierarchy(grown.hierarchy, "{}"));
  options.semi_regular = true;
  EXPECT_EQ(run(soup, options).hierarchy.operation_count(), 0);
}

TEST(Remesh, LevelsAreExactWhenAskedFor) {
  RemeshOptions options;
  options.levels = 2;
  options.vertices = 3000;
  Context context;
  EXPECT_EQ(remesh(ball(16), options, context).hierarchy.depth(), 2);
}

RemeshResult within(const PolygonSoup& soup, double error, std::int64_t vertices = 0, int levels = -1) {
  RemeshOptions options;
  options.error = error;
  options.vertices = vertices;
  options.levels = levels;
  Context context;
  return remesh(soup, options, context);
}

TEST(Remesh, AnErrorBoundIsMetByFewVertices) {
  for (const PolygonSoup& soup : {ball(16), torus(60, 30)})
    for (const double error : {1e-2, 2e-3, 5e-4}) {
      const RemeshResult r = within(soup, error);
      EXPECT_LE(r.report["final"]["l2"].get<double>(), error);
      EXPECT_TRUE(r.report["final"]["error_bound_met"].get<bool>());
      EXPECT_TRUE(find_defects(r.hierarchy).empty());
      EXPECT_EQ(r.report["base"]["quads"].get<int>(), r.hierarchy.base_count());
      // Half as many do not meet it, as far as the topology has a mesh of so few.
      const auto half = static_cast<std::int64_t>(r.final_mesh.points.size() / 2);
      if (half > 30) {
        EXPECT_GT(run(soup, half, Refinement::Uniform).report["final"]["l2"].get<double>(), error);
      }
    }
}

TEST(Remesh, AnErrorBoundHoldsWithinTheOtherBounds) {
  const PolygonSoup soup = torus(60, 30);
  const RemeshResult alone = within(soup, 1e-3), both = within(soup, 1e-3, 20000), levels = within(soup, 1e-3, 0, 2);
  EXPECT_LE(both.report["final"]["l2"].get<double>(), 1e-3);
  EXPECT_LT(both.final_mesh.points.size(), 2 * alone.final_mesh.points.size());
  EXPECT_LE(levels.report["final"]["l2"].get<double>(), 1e-3);
  EXPECT_EQ(levels.hierarchy.depth(), 2);
  // The bound on the vertices goes before the one on the error.
  const RemeshResult few = within(soup, 1e-6, 500);
  EXPECT_LE(few.final_mesh.points.size(), 500u);
  EXPECT_GE(few.final_mesh.points.size(), 490u);
  EXPECT_FALSE(few.report["final"]["error_bound_met"].get<bool>());
}

TEST(Remesh, AnErrorBoundOutOfReachIsRefused) {
  try {
    within(ball(16), 1e-12);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::InvalidInput);
    EXPECT_NE(std::string(e.what()).find("out of reach"), std::string::npos);
  }
}

TEST(Remesh, RefusesWhatItCannotDoWithTheReason) {
  const auto message = [](const PolygonSoup& soup, const RemeshOptions& options) -> std::string {
    Context context;
    try {
      remesh(soup, options, context);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::InvalidInput);
      return e.what();
    }
    return "";
  };
  RemeshOptions tiny;
  tiny.vertices = 3;
  EXPECT_NE(message(torus(30, 20), tiny).find("at least"), std::string::npos);
  RemeshOptions negative;
  negative.vertices = -1;
  EXPECT_NE(message(ball(4), negative).find("vertices"), std::string::npos);
  EXPECT_NE(message(PolygonSoup(), RemeshOptions()), "");
  RemeshOptions strict;
  strict.strict = true;
  EXPECT_NE(message(ball(4), strict).find("points to merge"), std::string::npos);
}

TEST(Remesh, CancelEndsItWherever) {
  for (const double at : {0.0, 0.1, 0.3, 0.6, 0.9}) {
    Context context;
    std::thread watcher([&] {
      while (context.progress() < at) std::this_thread::yield();
      context.cancel();
    });
    RemeshOptions options;
    options.vertices = 4000;
    try {
      remesh(ball(30), options, context);
      ADD_FAILURE() << "it ended all the same, cancelled at " << at;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Cancelled) << error.what();
    }
    EXPECT_GE(context.progress(), at);
    EXPECT_LT(context.progress(), 1);
    watcher.join();
  }
}

TEST(Fit, PullsAMeshOntoThePlaneItsSamplesLieIn) {
  HybridMesh h = HybridMesh::from_base(4, {{0, 1, 2, 3}});
  h.refine_uniform(3);
  QuadMesh mesh = h.level_mesh(3);
  const std::vector<char> fixed(mesh.points.size(), 0);
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    mesh.points[v] = Vec3(mesh.location[v].u, mesh.location[v].v, 0.02 * std::sin(9.0 * static_cast<double>(v)));
  std::vector<FitSample> samples;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) samples.push_back({Vec3((i + 0.5) / 60, (j + 0.5) / 60, 0.1), Vec3(0, 0, 1), 1.0, 0});
  for (FitSample& s : samples)
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      Vec3 c = Vec3::Zero();
      for (int k = 0; k < 4; ++k) c += 0.25 * mesh.points[mesh.indices[mesh.offsets[f] + k]];
      if (std::abs(c.x() - s.position.x()) < 0.0626 && std::abs(c.y() - s.position.y()) < 0.0626) s.face = static_cast<int>(f);
    }
  Context context;
  fit_mesh(mesh, fixed, {}, samples, FitOptions(), Progress(context));
  for (const Vec3& p : mesh.points) EXPECT_NEAR(p.z(), 0.1, 2e-3);
}

}  // namespace
}  // namespace hybrid_mesh
