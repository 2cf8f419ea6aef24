// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/global_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include "generated_surfaces.h"
#include "layout/base/base_domain.h"
#include "layouts.h"
#include "parameterization/initial_map.h"
#include "parameterization/patch_extraction.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::expect_bijective;
using testing::repaired;
using testing::torus;

struct Mapped {
  TriangleSurface surface;
  PatchedSurface patches;
  std::unique_ptr<ChartMesh> charts;
};

Mapped map_of(const PolygonSoup& soup, double size) {
  Mapped m;
  m.surface = testing::unit(repaired(soup));
  Context context;
  BaseDomainOptions options;
  options.size = size;
  m.patches = BaseDomain(m.surface, {}, options, Progress(context)).cut(testing::whole_surface, Progress(context)).patches;
  const auto corners = map_patches(m.patches, Progress(context));
  m.charts = std::make_unique<ChartMesh>(m.patches, corners);
  return m;
}

TEST(Transition, InverseAndCompositionAreThoseOfTheMap) {
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const Transition t = across(i, j);
      EXPECT_EQ(t * t.inverse(), Transition());
      EXPECT_EQ(t.inverse(), across(j, i));
      const Complex z(0.3, 0.8);
      EXPECT_LT(std::abs((t * across(j, i))(z)-z), 1e-15);
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
    for (const auto& f : m.surface.faces)
      whole += 0.5 * (m.surface.points[f[1]] - m.surface.points[f[0]]).cross(m.surface.points[f[2]] - m.surface.points[f[0]]).norm();
    EXPECT_NEAR(area, whole, 1e-6 * whole);
  }
}

// A square of which the four corners of its one quad lie `turns` vertices farther along the boundary: its vertices wind around the middle, the more
// the farther out.
PatchedSurface wound_square(int half, int turns) {
  const int n = 2 * half + 1;
  const auto index = [&](int x, int y) { return (y + half) * n + x + half; };
  PatchedSurface s;
  for (int y = -half; y <= half; ++y)
    for (int x = -half; x <= half; ++x) {
      const int r = std::max(std::abs(x), std::abs(y));
      // Along the square of vertices at that distance, counter-clockwise from its corner at the lower left.
      double at = y == -r ? x + r : x == r ? 3 * r + y : y == r ? 5 * r - x : 7 * r - y;
      if (r > 0) at = std::fmod(at + turns * static_cast<double>(r * r) / (half * half) + 8 * r, 8 * r);
      const int side = r > 0 ? std::min(3, static_cast<int>(at / (2 * r))) : 0;
      const double along = at - 2 * r * side - r;
      const std::array<Vec3, 4> places{Vec3(along, -r, 0), Vec3(r, along, 0), Vec3(-along, r, 0), Vec3(-r, -along, 0)};
      s.mesh.points.push_back(places[side] / half);
      s.source.push_back({{index(x, y), -1, -1}, {1, 0, 0}});
    }
  for (int y = -half; y < half; ++y)
    for (int x = -half; x < half; ++x) {
      // Diagonals from the middle outwards: a vertex with one triangle can only be a corner.
      const std::array<int, 4> c{index(x, y), index(x + 1, y), index(x + 1, y + 1), index(x, y + 1)};
      const int k = (x < 0) == (y < 0) ? 0 : 1;
      s.mesh.faces.push_back({c[k], c[k + 1], c[k + 2]});
      s.mesh.faces.push_back({c[k], c[k + 2], c[(k + 3) % 4]});
    }
  for (std::size_t f = 0; f < s.mesh.faces.size(); ++f) s.mesh.source_face.push_back(static_cast<int>(f));
  connect_half_edges(s.mesh);
  s.node_count = 4;
  s.nodes = {{0, 1, 2, 3}};
  s.neighbours.resize(1);
  s.patch.assign(s.mesh.faces.size(), 0);
  s.sides.resize(1);
  for (int i = -half; i <= half; ++i) {
    s.sides[0][0].push_back(index(i, -half));
    s.sides[0][1].push_back(index(half, i));
    s.sides[0][2].push_back(index(-i, half));
    s.sides[0][3].push_back(index(-half, -i));
  }
  return s;
}

TEST(GlobalMap, CornersMoveAlongTheBoundaryToWhereItTurns) {
  for (const int turns : {1, 3, -2}) {
    PatchedSurface square = wound_square(10, turns);
    Context context;
    GlobalMapOptions options;
    options.vertices_a_quad = 1e6;
    ChartMesh held(square, map_patches(square, Progress(context))), free = held;
    options.corners_move = false;
    EXPECT_GT(smooth_map(held, square, options, Progress(context)).energy, 1.001);
    options.corners_move = true;
    EXPECT_NEAR(smooth_map(free, square, options, Progress(context)).energy, 1, 1e-6);
    expect_bijective(free);
    int corners = 0;
    for (std::size_t v = 0; v < free.points.size(); ++v) {
      if (free.kind[v] != ChartMesh::Kind::Pinned) continue;
      ++corners;
      EXPECT_NEAR(std::abs(free.points[v].x()), 1, 1e-12);
      EXPECT_NEAR(std::abs(free.points[v].y()), 1, 1e-12);
    }
    EXPECT_EQ(corners, 4);
  }
}

}  // namespace
}  // namespace hybrid_mesh
