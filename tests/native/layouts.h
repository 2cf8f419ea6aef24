// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numbers>
#include <set>

#include "parameterization/chart_mesh.h"
#include "remesh/working_surface.h"

namespace hybrid_mesh::testing {

// Vertices a quad of a base that is cut out of the surface itself, not out of a coarser version.
inline constexpr double whole_surface = std::numeric_limits<double>::infinity();

inline TriangleSurface unit(TriangleSurface s) {
  const Placement p = placement_of(s.points);
  for (Vec3& x : s.points) x = p.to_unit(x);
  return s;
}

// Every patch is a disk whose rim is made of its four sides; sides are shared; the patches tile the surface.
inline void expect_layout(const TriangleSurface& surface, const PatchedSurface& p) {
  double before = 0, after = 0;
  for (const auto& f : surface.faces)
    before += (surface.points[f[1]] - surface.points[f[0]]).cross(surface.points[f[2]] - surface.points[f[0]]).norm();
  for (const auto& f : p.mesh.faces) after += (p.mesh.points[f[1]] - p.mesh.points[f[0]]).cross(p.mesh.points[f[2]] - p.mesh.points[f[0]]).norm();
  EXPECT_NEAR(after, before, 1e-9 * before);
  std::vector<std::set<int>> vertices(p.patch_count());
  std::vector<std::set<std::pair<int, int>>> edges(p.patch_count());
  std::vector<long> faces(p.patch_count(), 0);
  for (std::size_t f = 0; f < p.mesh.faces.size(); ++f) {
    const int q = p.patch[f];
    ASSERT_GE(q, 0);
    ++faces[q];
    for (int i = 0; i < 3; ++i) {
      vertices[q].insert(p.mesh.faces[f][i]);
      edges[q].insert(std::minmax(p.mesh.faces[f][i], p.mesh.faces[f][(i + 1) % 3]));
    }
  }
  for (int q = 0; q < p.patch_count(); ++q) {
    EXPECT_EQ(static_cast<long>(vertices[q].size()) - static_cast<long>(edges[q].size()) + faces[q], 1) << "patch " << q << " is no disk";
    for (int i = 0; i < 4; ++i) {
      const std::vector<int>& side = p.sides[q][i];
      ASSERT_GE(side.size(), 2u);
      EXPECT_EQ(side.back(), p.sides[q][(i + 1) % 4].front());
      for (std::size_t k = 1; k < side.size(); ++k) EXPECT_TRUE(edges[q].count(std::minmax(side[k - 1], side[k])));
      const PatchSide other = p.neighbours[q][i];
      if (other.patch < 0) continue;
      std::vector<int> reversed = p.sides[other.patch][other.side];
      std::reverse(reversed.begin(), reversed.end());
      EXPECT_EQ(reversed, side);
      EXPECT_EQ(p.neighbours[other.patch][other.side].patch, q);
      EXPECT_EQ(p.neighbours[other.patch][other.side].side, i);
    }
  }
  // Points lie where their sources say.
  for (std::size_t v = 0; v < p.mesh.points.size(); ++v) {
    Vec3 at = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (p.source[v].vertices[k] >= 0) at += p.source[v].weights[k] * surface.points[p.source[v].vertices[k]];
    EXPECT_LT((at - p.mesh.points[v]).norm(), 1e-12);
  }
}

// Every triangle counter-clockwise, every vertex wound around once (a cone of k quads: k quarter turns), charts glued consistently.
inline void expect_bijective(const ChartMesh& c) {
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

}  // namespace hybrid_mesh::testing
