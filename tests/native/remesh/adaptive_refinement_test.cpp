// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/adaptive_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "generated_surfaces.h"
#include "hierarchy/bases.h"
#include "remesh/quality.h"
#include "remesh/remesh.h"
#include "remesh/surface_fit.h"
#include "surface/distance.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh {
namespace {

struct Landscape {
  HybridMesh hierarchy;
  PolygonSoup surface;
};

// Columns x rows base quads under a height field that is flat but for a narrow hill and a wave; the surface is the maps' own triangles.
Landscape landscape(int columns, int rows) {
  Landscape l{grid(columns, rows), {}};
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      PatchMap map = make_map(48, 0.2, 7u + y * columns + x, [&](double u, double v) {
        const double a = (x + u) / columns, b = (y + v) / rows;
        const double hill = std::exp(-60 * ((a - 0.3) * (a - 0.3) + (b - 0.4) * (b - 0.4)));
        return Vec3(a, b, 0.15 * hill + 0.02 * std::sin(9 * a) * std::cos(7 * b));
      });
      const auto shift = static_cast<std::int32_t>(l.surface.points.size());
      l.surface.points.insert(l.surface.points.end(), map.positions.begin(), map.positions.end());
      for (const auto& t : map.triangles) {
        for (const int v : t) l.surface.indices.push_back(v + shift);
        l.surface.offsets.push_back(static_cast<std::int64_t>(l.surface.indices.size()));
      }
      l.hierarchy.set_map(y * columns + x, std::move(map));
    }
  return l;
}

QuadMesh refined(Landscape& l, const AdaptiveOptions& options) {
  Context context;
  return refine_adaptively(l.hierarchy, DistanceReference(l.surface), options, Progress(context));
}

QuadMesh refined_to(Landscape& l, std::int64_t vertices) {
  AdaptiveOptions options;
  options.vertices = vertices;
  return refined(l, options);
}

double distance(const Landscape& l, const QuadMesh& mesh) {
  Context context;
  return surface_distance(l.surface, to_soup(mesh), DistanceOptions(), Progress(context)).l2;
}

std::string name_of(const ::testing::TestParamInfo<FaceClosure>& info) {
  return info.param == FaceClosure::Quads ? "Quads" : info.param == FaceClosure::Transition ? "Transition" : "Triangles";
}

class Closures : public ::testing::TestWithParam<FaceClosure> {};
INSTANTIATE_TEST_SUITE_P(AdaptiveRefinement, Closures, ::testing::Values(FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles),
                         name_of);

TEST_P(Closures, UsesItsBudgetIsBalancedAndKeepsTheTopology) {
  for (const auto& [columns, rows] : {std::pair(1, 1), std::pair(3, 2)})
    for (const std::int64_t budget : {200, 333, 500, 1000, 2500}) {
      Landscape l = landscape(columns, rows);
      l.hierarchy.set_closure(GetParam());
      const QuadMesh mesh = refined_to(l, budget);
      const auto vertices = static_cast<std::int64_t>(mesh.points.size());
      EXPECT_LE(vertices, budget);
      EXPECT_GE(static_cast<double>(vertices), 0.98 * static_cast<double>(budget)) << columns << " x " << rows << ", " << budget;
      EXPECT_EQ(find_defects(l.hierarchy), std::vector<std::string>());
      EXPECT_EQ(l.hierarchy.final_mesh().vertex_count(), mesh.vertex_count());
      const TopologySummary t = summarize_topology(to_soup(mesh));
      EXPECT_EQ(t.nonmanifold_edges + t.nonmanifold_vertices + t.misoriented_edges, 0);
      EXPECT_EQ(t.euler, 1);
      EXPECT_EQ(t.boundary_loops, 1);
    }
}

TEST_P(Closures, ComesCloserTheMoreVerticesItHas) {
  double previous = 1;
  for (const std::int64_t budget : {300, 800, 2000}) {
    Landscape l = landscape(3, 2);
    l.hierarchy.set_closure(GetParam());
    const QuadMesh mesh = refined_to(l, budget);
    const double d = distance(l, mesh);
    EXPECT_LT(d, 0.7 * previous) << budget;
    previous = d;
  }
}

TEST_P(Closures, MeetsAnErrorWithNearlyTheFewestVertices) {
  const double error = 1e-3;
  AdaptiveOptions options;
  options.error = error;
  Landscape l = landscape(2, 1);
  l.hierarchy.set_closure(GetParam());
  const QuadMesh mesh = refined(l, options);
  EXPECT_LE(distance(l, mesh), error);
  // With a good part of the vertices gone the error is missed.
  Landscape fewer = landscape(2, 1);
  fewer.hierarchy.set_closure(GetParam());
  const QuadMesh coarse = refined_to(fewer, static_cast<std::int64_t>(0.75 * static_cast<double>(mesh.points.size())));
  EXPECT_GT(distance(fewer, coarse), error);
  // A bound on the vertices that is not in the way changes nothing.
  Landscape bounded = landscape(2, 1);
  bounded.hierarchy.set_closure(GetParam());
  options.vertices = 20000;
  EXPECT_EQ(refined(bounded, options).points, mesh.points);
}

TEST_P(Closures, UsesTheVerticesAllowedWhereTheyDoNotSufficeForTheError) {
  AdaptiveOptions options;
  options.error = 1e-6;
  options.vertices = 700;
  Landscape l = landscape(2, 2);
  l.hierarchy.set_closure(GetParam());
  const QuadMesh mesh = refined(l, options);
  EXPECT_LE(mesh.points.size(), 700u);
  EXPECT_GE(static_cast<double>(mesh.points.size()), 0.98 * 700);
}

TEST(AdaptiveRefinement, IsTheSameEveryTime) {
  Landscape a = landscape(3, 2), b = landscape(3, 2);
  const QuadMesh first = refined_to(a, 1500), second = refined_to(b, 1500);
  EXPECT_EQ(first.points, second.points);
  EXPECT_EQ(first.indices, second.indices);
}

TEST(AdaptiveRefinement, PutsSmallQuadsWhereTheSurfaceBends) {
  Landscape l = landscape(3, 3);
  refined_to(l, 3000);
  double on_hill = 0, everywhere = 0;
  for (const int leaf : l.hierarchy.leaves()) {
    const Vec3 p = l.hierarchy.sample(l.hierarchy.corner(leaf, 0)).position;
    ++everywhere;
    on_hill += std::hypot(p.x() - 0.3, p.y() - 0.4) < 0.15;
  }
  const double area_of_hill = std::numbers::pi * 0.15 * 0.15;
  EXPECT_GT(on_hill / everywhere, 2 * area_of_hill);
}

TEST(AdaptiveRefinement, ComesCloserThanAUniformMeshOfAsManyVertices) {
  Landscape uniform = landscape(3, 2);
  uniform.hierarchy.refine_uniform(4);
  QuadMesh mesh = uniform.hierarchy.level_mesh(4);
  Context context;
  fit_to_surface(mesh, uniform.hierarchy, SurfaceFitOptions(), Progress(context));
  Landscape adaptive = landscape(3, 2);
  const QuadMesh other = refined_to(adaptive, static_cast<std::int64_t>(mesh.points.size()));
  EXPECT_LT(distance(adaptive, other), 0.8 * distance(uniform, mesh));
}

TEST(SurfaceFit, ComesCloserWhereSquareQuadsMaySlideAndFoldsNone) {
  double distances[2];
  for (const int slide : {0, 1}) {
    Landscape l = landscape(3, 2);
    l.hierarchy.refine_uniform(3);
    QuadMesh mesh = l.hierarchy.level_mesh(3);
    SurfaceFitOptions options;
    if (slide) options.first.square_smoothness = 0.1 * options.first.smoothness;
    Context context;
    fit_to_surface(mesh, l.hierarchy, options, Progress(context));
    distances[slide] = distance(l, mesh);
    EXPECT_EQ(quad_quality(mesh).inverted, 0);
  }
  EXPECT_LT(distances[1], distances[0]);
}

TEST(AdaptiveRefinement, KeepsToTheDeepestLevelAllowed) {
  AdaptiveOptions options;
  options.vertices = 100000;
  options.deepest = 2;
  Landscape l = landscape(2, 1);
  refined(l, options);
  EXPECT_EQ(l.hierarchy.depth(), 2);
}

TEST(AdaptiveRefinement, RefusesABaseThatIsTooLarge) {
  Landscape l = landscape(3, 2);
  EXPECT_THROW(refined_to(l, 11), Error);
  EXPECT_EQ(refined_to(l, 12).points.size(), 12u);
}

TEST(AdaptiveRefinement, CanBeCancelled) {
  Landscape l = landscape(2, 2);
  Context context;
  context.cancel();
  AdaptiveOptions options;
  options.vertices = 1000;
  EXPECT_THROW(refine_adaptively(l.hierarchy, DistanceReference(l.surface), options, Progress(context)), Error);
}

RemeshResult remeshed(const PolygonSoup& soup, std::int64_t vertices, double error, FaceClosure faces) {
  RemeshOptions options;
  options.vertices = vertices;
  options.error = error;
  options.faces = faces;
  options.refinement = Refinement::Adaptive;
  Context context;
  return remesh(soup, options, context);
}

TEST(AdaptiveRemesh, SmallBudgetsAreUsed) {
  for (const PolygonSoup& soup : {testing::ball(12), testing::ball(12, 0.3)})
    for (const std::int64_t budget : {300, 500}) {
      const auto vertices = static_cast<double>(remeshed(soup, budget, 0, FaceClosure::Quads).final_mesh.points.size());
      EXPECT_LE(vertices, budget);
      EXPECT_GE(vertices, 0.98 * static_cast<double>(budget)) << budget;
    }
}

TEST(AdaptiveRemesh, ErrorsAreMetAsReportedOrMissedWithAReason) {
  for (const FaceClosure faces : {FaceClosure::Quads, FaceClosure::Triangles}) {
    const RemeshResult met = remeshed(testing::torus(40, 20), 0, 1e-3, faces);
    EXPECT_LE(met.report["final"]["l2"].get<double>(), 1e-3);
    EXPECT_EQ(met.report["verdict"]["result"], "good");
    const RemeshResult missed = remeshed(testing::torus(40, 20), 400, 1e-5, faces);
    EXPECT_LE(missed.final_mesh.points.size(), 400u);
    ASSERT_EQ(missed.report["verdict"]["reasons"].size(), 1u);
    EXPECT_EQ(missed.report["verdict"]["reasons"][0]["what"], "error");
  }
}

}  // namespace
}  // namespace hybrid_mesh
