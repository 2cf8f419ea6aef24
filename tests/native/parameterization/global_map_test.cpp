// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/global_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <memory>
#include <numbers>

#include "generated_surfaces.h"
#include "layout/base_domain.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_extraction.h"
#include "remesh/working_surface.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::repaired;
using testing::torus;

struct Mapped {
  TriangleSurface surface;
  PatchedSurface patches;
  std::unique_ptr<ChartMesh> charts;
};

Mapped map_of(const PolygonSoup& soup, double size) {
  Mapped m;
  m.surface = repaired(soup);
  const Placement p = placement_of(m.surface.points);
  for (Vec3& x : m.surface.points) x = p.to_unit(x);
  Context context;
  BaseDomainOptions options;
  options.size = size;
  m.patches = make_base_domain(m.surface, options, Progress(context));
  const auto corners = map_patches(m.patches, Progress(context));
  m.charts = std::make_unique<ChartMesh>(m.patches, corners);
  return m;
}

// Every triangle counter-clockwise, every vertex wound around once (a cone of k quads: k quarter turns), charts glued consistently.
void expect_bijective(const ChartMesh& c) {
  for (int f = 0; f < static_cast<int>(c.mesh.alive.size()); ++f)
    if (c.mesh.alive[f]) {
      EXPECT_GT(c.determinant(f), 0);
    }
  for (int v = 0; v < static_cast<int>(c.points.size()); ++v) {
    if (!c.mesh.vertex_alive(v) || c.mesh.is_boundary(v)) continue;
    const double turns = c.angle_at(v) / (0.5 * std::numbers::pi);
    EXPECT_NEAR(turns, std::round(turns), 1e-6);
    if (c.kind[v] != ChartMesh::Kind::Cone) {
      EXPECT_NEAR(turns, 4, 1e-6);
    }
  }
  for (int h = 0; h < static_cast<int>(c.mesh.origin.size()); ++h) {
    const int o = c.mesh.opposite[h];
    if (!c.mesh.alive[h / 3] || o < 0) continue;
    EXPECT_LT(std::abs(c.gluing[h](c.at(h)) - c.at(EditMesh::next(o))), 1e-9);
    EXPECT_LT(std::abs(c.gluing[h](c.at(EditMesh::next(h))) - c.at(o)), 1e-9);
  }
}

TEST(Transition, InverseAndCompositionAreThoseOfTheMap) {
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const Transition t = across(i, j);
      EXPECT_EQ(t * t.inverse(), Transition());
      EXPECT_EQ(t.inverse(), across(j, i));
      const Complex z(0.3, 0.8);
      EXPECT_LT(std::abs((t * across(j, i))(z) - z), 1e-15);
      EXPECT_LT(std::abs(t.back(t(z)) - z), 1e-15);
    }
}

TEST(Distortion, DerivativesAreThoseOfTheValue) {
  const Distortion d{0.4};
  const double s = 1.3, t = 0.2, e = 1e-5;
  const auto x = d(s, t);
  EXPECT_NEAR(x.value, d.value(s, t), 1e-14);
  EXPECT_NEAR(x.s, (d.value(s + e, t) - d.value(s - e, t)) / (2 * e), 1e-8);
  EXPECT_NEAR(x.t, (d.value(s, t + e) - d.value(s, t - e)) / (2 * e), 1e-8);
  EXPECT_NEAR(x.ss, (d(s + e, t).s - d(s - e, t).s) / (2 * e), 1e-8);
  EXPECT_NEAR(x.st, (d(s, t + e).s - d(s, t - e).s) / (2 * e), 1e-8);
  EXPECT_NEAR(x.tt, (d(s, t + e).t - d(s, t - e).t) / (2 * e), 1e-8);
  // An isometry costs 1, and nothing costs less.
  EXPECT_DOUBLE_EQ(d.value(1, 0), 1);
}

TEST(ChartMesh, CollapsesAndTheirUndoingKeepTheMapBijective) {
  Mapped m = map_of(ball(10), 30);
  ChartMesh& c = *m.charts;
  expect_bijective(c);
  std::vector<int> log;
  for (int h = 0; h < static_cast<int>(c.mesh.origin.size()); ++h) {
    if (!c.mesh.alive[h / 3] || !c.can_collapse(h)) continue;
    const Complex target = c.corner[h].back(c.at(EditMesh::next(h)));
    bool good = true;
    c.for_star(c.mesh.from(h), [&](int g, const Complex& a, const Complex& b) {
      if (c.mesh.to(g) == c.mesh.to(h) || c.mesh.apex(g) == c.mesh.to(h)) return;
      good &= ((b - a) * std::conj(target - a)).imag() < -1e-6;
    });
    if (!good || c.kind[c.mesh.to(h)] == ChartMesh::Kind::Cone) continue;
    c.collapse(h);
    log.push_back(h);
  }
  EXPECT_GT(log.size(), 50u);
  expect_bijective(c);
  while (!log.empty()) {
    EXPECT_TRUE(c.undo_collapse(log.back()));
    log.pop_back();
  }
  expect_bijective(c);
}

TEST(GlobalMap, StaysBijectiveAndGetsBetterOnEveryKindOfSurface) {
  for (const PolygonSoup& soup : {ball(14), ball(12, 0.5), torus(48, 24)}) {
    Mapped m = map_of(soup, 40);
    Context context;
    const GlobalMapReport report = smooth_map(*m.charts, m.patches, GlobalMapOptions(), Progress(context));
    EXPECT_LT(report.energy, report.energy_before);
    EXPECT_LT(report.energy, 1.3);
    expect_bijective(*m.charts);
    const std::vector<PatchMap> maps = extract_patch_maps(*m.charts, m.patches, m.surface.faces, Progress(context));
    double area = 0;
    for (const PatchMap& map : maps) {
      EXPECT_STREQ(find_map_defect(map), "");
      for (std::size_t t = 0; t < map.triangles.size(); ++t) {
        const auto& x = map.triangles[t];
        area += 0.5 * (map.positions[x[1]] - map.positions[x[0]]).cross(map.positions[x[2]] - map.positions[x[0]]).norm();
        // The sources name the same points.
        for (int k = 0; k < 3; ++k) {
          Vec3 p = Vec3::Zero();
          for (int i = 0; i < 3; ++i) p += map.source[t][3 * k + i] * m.surface.points[m.surface.faces[map.source_face[t]][i]];
          EXPECT_LT((p - map.positions[x[k]]).norm(), 1e-6);
        }
      }
    }
    double whole = 0;
    for (const auto& f : m.surface.faces) whole += 0.5 * (m.surface.points[f[1]] - m.surface.points[f[0]]).cross(m.surface.points[f[2]] - m.surface.points[f[0]]).norm();
    EXPECT_NEAR(area, whole, 1e-6 * whole);
  }
}

}  // namespace
}  // namespace hybrid_mesh
