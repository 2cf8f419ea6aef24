// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/curves/surface_curves.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "generated_surfaces.h"
#include "layout/curves/curve_tightening.h"
#include "layouts.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::repaired;
using testing::torus;
using testing::unit;

struct Shape {
  std::string name;
  TriangleSurface surface;
};

std::vector<Shape> shapes() {
  return {{"ball", unit(repaired(ball(6)))},       {"open ball", unit(repaired(ball(6, 0.3)))},
          {"torus", unit(repaired(torus(14, 8)))}, {"cube", unit(repaired(cube()))},
          {"grid", unit(repaired(grid(5, 4)))},    {"cylinder", unit(repaired(glued_rectangle(9, 4, false, false)))}};
}

// From a vertex through faces at random, to the apex of the last.
int add_random_curve(SurfaceCurves& curves, TestRandom& random, int steps, int stroke) {
  const EditMesh& mesh = curves.mesh();
  int h = EditMesh::next(3 * random.below(curves.face_count()) + random.below(3));
  const int start = mesh.apex(h);
  std::vector<SurfaceCurves::Step> way;
  for (int i = 0; i < steps && mesh.opposite[h] >= 0; ++i) {
    way.push_back({h, 0.05 + 0.9 * random.unit()});
    h = random.below(2) ? EditMesh::next(mesh.opposite[h]) : EditMesh::prev(mesh.opposite[h]);
  }
  if (way.empty()) return -1;
  return curves.add(start, mesh.apex(mesh.opposite[way.back().half_edge]), way, stroke);
}

// The next vertex of the boundary, or the one before.
int along_boundary(const EditMesh& mesh, int v, bool forward) {
  int g = mesh.out[v];
  if (forward) return mesh.to(g);
  while (mesh.ccw(g) >= 0) g = mesh.ccw(g);
  return mesh.apex(g);
}

double area(const TriangleSurface& s) {
  double sum = 0;
  for (const auto& f : s.faces) sum += (s.points[f[1]] - s.points[f[0]]).cross(s.points[f[2]] - s.points[f[0]]).norm();
  return sum;
}

// The cut surface is the same surface, and its curves are chains of edges that meet at their ends only.
void expect_cut(const TriangleSurface& surface, const SurfaceCurves& curves) {
  ASSERT_STREQ(curves.find_defect(), "");
  const CutMesh cut = curves.cut();
  EXPECT_NEAR(area(cut.mesh), area(surface), 1e-9 * area(surface));
  std::set<int> inner, ends;
  std::size_t marked = 0, edges = 0;
  for (const int c : cut.curve) marked += c >= 0;
  for (int c = 0; c < curves.curve_count(); ++c) {
    const std::vector<int>& chain = cut.chains[c];
    if (!curves.curve(c).alive) {
      EXPECT_TRUE(chain.empty());
      continue;
    }
    edges += chain.size() - 1;
    ends.insert(chain.front()), ends.insert(chain.back());
    for (std::size_t k = 1; k + 1 < chain.size(); ++k) EXPECT_TRUE(inner.insert(chain[k]).second) << "two curves share a point";
  }
  EXPECT_EQ(marked, 2 * edges);
  for (const int v : ends) EXPECT_FALSE(inner.count(v));
  for (std::size_t v = 0; v < cut.source.size(); ++v) {
    Vec3 at = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (cut.source[v].vertices[k] >= 0) at += cut.source[v].weights[k] * surface.points[cut.source[v].vertices[k]];
    EXPECT_LT((at - cut.mesh.points[v]).norm(), 1e-12);
  }
}

TEST(SurfaceCurves, RandomCurvesBecomeDisjointWhateverIsDoneToThem) {
  for (const Shape& shape : shapes())
    for (int seed = 0; seed < 60; ++seed) {
      SCOPED_TRACE(shape.name + " " + std::to_string(seed));
      TestRandom random(seed);
      Context context;
      SurfaceCurves curves(shape.surface, shape.surface.points);
      const int count = 1 + random.below(6);
      for (int i = 0; i < count; ++i) add_random_curve(curves, random, 1 + random.below(30), i);
      curves.resolve_crossings(Progress(context));
      ASSERT_STREQ(curves.find_defect(), "");
      if (seed % 3 == 0) {
        expect_cut(shape.surface, curves);
        if (::testing::Test::HasFatalFailure()) return;
      }
      for (int step = 0; step < 40; ++step) {
        const int kind = random.below(6);
        if (kind == 0) {
          curves.split_face(random.below(curves.face_count()), {0.2, 0.5, 0.3});
        } else if (kind == 1) {
          curves.split_edge(random.below(3 * curves.face_count()), 0.1 + 0.8 * random.unit());
        } else if (kind == 2) {
          std::vector<int> all;
          for (int c = 0; c < curves.curve_count(); ++c)
            if (curves.curve(c).alive && curves.curve(c).start != curves.curve(c).end) all.push_back(c);
          if (all.empty()) continue;
          const int c = all[random.below(static_cast<int>(all.size()))], v = random.below(2) ? curves.curve(c).start : curves.curve(c).end;
          if (!curves.mesh().is_boundary(v)) curves.contract(c, v);
        } else if (kind == 3) {
          curves.dissolve(random.below(static_cast<int>(curves.points().size())));
        } else if (kind == 4) {
          const int v = random.below(static_cast<int>(curves.points().size()));
          if (!curves.mesh().is_boundary(v) || curves.degree(v) == 0) continue;
          const bool forward = random.below(2);
          int w = v;
          for (int k = 1 + random.below(4); k > 0 && (w == v || curves.degree(w) == 0); --k) w = along_boundary(curves.mesh(), w, forward);
          if (w != v) curves.slide(v, w, forward);
        } else {
          std::vector<int> all;
          for (int c = 0; c < curves.curve_count(); ++c)
            if (curves.curve(c).alive) all.push_back(c);
          if (all.empty()) continue;
          const int c = all[random.below(static_cast<int>(all.size()))];
          const double before = curves.length(c);
          if (CurveTightener(curves, {}).tighten(c)) {
            EXPECT_LE(curves.length(c), before * (1 + 1e-9));
          }
          curves.spread();
        }
        ASSERT_STREQ(curves.find_defect(), "") << "after " << kind << " in step " << step;
      }
      expect_cut(shape.surface, curves);
      if (::testing::Test::HasFatalFailure()) return;
    }
}

TEST(CurveTightening, AWanderingCurveInThePlaneBecomesStraight) {
  const TriangleSurface surface = unit(repaired(grid(12, 9)));
  int tried = 0;
  for (int seed = 0; seed < 200; ++seed) {
    TestRandom random(seed);
    SurfaceCurves curves(surface, surface.points);
    const int c = add_random_curve(curves, random, 5 + random.below(60), 0);
    curves.spread();
    if (c < 0 || curves.curve(c).start == curves.curve(c).end || *curves.find_defect()) continue;  // it crosses itself
    ++tried;
    const Vec3 a = surface.points[curves.curve(c).start], b = surface.points[curves.curve(c).end];
    if (!CurveTightener(curves, {}).tighten(c)) continue;  // along the boundary
    EXPECT_LT(curves.length(c), (b - a).norm() * 1.01 + 1e-3);
    for (const Vec3& p : curves.polyline(c)) EXPECT_LT((p - a).cross(b - a).norm(), 0.002 * (b - a).norm());
  }
  EXPECT_GT(tried, 20);
}

TEST(CurveTightening, OnASphereAGreatCircleIsLeft) {
  PolygonSoup soup = ball(16);
  for (Vec3& p : soup.points) p.normalize();
  const TriangleSurface surface = repaired(soup);
  int tried = 0;
  for (int seed = 0; seed < 200; ++seed) {
    TestRandom random(seed);
    SurfaceCurves curves(surface, surface.points);
    const int c = add_random_curve(curves, random, 5 + random.below(60), 0);
    curves.spread();
    if (c < 0 || *curves.find_defect()) continue;  // it crosses itself
    const Vec3 a = surface.points[curves.curve(c).start], b = surface.points[curves.curve(c).end];
    const double arc = std::atan2(a.cross(b).norm(), a.dot(b));
    // A wandering curve may have gone around the far side.
    if (arc < 0.2 || curves.length(c) > 2 * std::numbers::pi - arc) continue;
    ++tried;
    ASSERT_TRUE(CurveTightener(curves, {}).tighten(c));
    EXPECT_LT(curves.length(c), 1.005 * arc);
  }
  EXPECT_GT(tried, 10);
}

}  // namespace
}  // namespace hybrid_mesh
