// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>

#include "drawn_strokes.h"
#include "layout/drawn/patch_layout.h"
#include "layouts.h"
#include "parameterization/initial_map.h"
#include "surface/closest_point.h"

namespace hybrid_mesh::testing {

// Whatever was drawn: curves are disjoint, lie on the surface, bound the faces that name them, and Euler's formula holds.
inline void expect_sound(const TriangleSurface& surface, const PatchLayout& l) {
  const double size = diagonal(surface);
  std::set<int> inner, nodes(l.nodes.begin(), l.nodes.end());
  ASSERT_EQ(nodes.size(), l.nodes.size());
  std::map<std::pair<int, int>, int> half_edge;
  for (int h = 0; h < static_cast<int>(l.mesh.opposite.size()); ++h) half_edge[{l.mesh.from(h), l.mesh.to(h)}] = h;
  std::size_t on_curves = 0, marked = 0;
  for (const int c : l.along) marked += c >= 0;
  for (int c = 0; c < static_cast<int>(l.curves.size()); ++c) {
    const PatchLayout::Curve& curve = l.curves[c];
    ASSERT_GE(curve.points.size(), 2u);
    EXPECT_EQ(curve.points.front(), l.nodes[curve.from]);
    EXPECT_EQ(curve.points.back(), l.nodes[curve.to]);
    for (std::size_t k = 1; k < curve.points.size(); ++k) {
      if (k + 1 < curve.points.size()) {
        EXPECT_TRUE(inner.insert(curve.points[k]).second) << "two curves meet outside nodes";
        EXPECT_FALSE(nodes.count(curve.points[k]));
      }
      const auto at = half_edge.find({curve.points[k - 1], curve.points[k]});
      ASSERT_NE(at, half_edge.end());
      EXPECT_EQ(l.along[at->second], c);
      EXPECT_EQ(l.mesh.opposite[at->second] < 0, curve.boundary);
      on_curves += curve.boundary ? 1 : 2;
    }
  }
  EXPECT_EQ(marked, on_curves);
  const SurfaceDistanceQuery query(surface);
  for (std::size_t v = 0; v < l.mesh.points.size(); ++v) {
    if (!inner.count(static_cast<int>(v)) && !nodes.count(static_cast<int>(v))) continue;
    EXPECT_LT(std::sqrt(query.closest(l.mesh.points[v]).squared_distance), 1e-12 * size);
  }
  double before = 0, after = 0;
  for (const auto& f : surface.faces)
    before += (surface.points[f[1]] - surface.points[f[0]]).cross(surface.points[f[2]] - surface.points[f[0]]).norm();
  for (const auto& f : l.mesh.faces) after += (l.mesh.points[f[1]] - l.mesh.points[f[0]]).cross(l.mesh.points[f[2]] - l.mesh.points[f[0]]).norm();
  EXPECT_NEAR(after, before, 1e-9 * before);
  // Points of every triangle lie on its face of the surface.
  for (std::size_t f = 0; f < l.mesh.faces.size(); ++f)
    for (const int v : l.mesh.faces[f]) {
      const std::array<double, 3> w = weights_in_face(l.source[v], surface.faces[l.mesh.source_face[f]]);
      EXPECT_NEAR(w[0] + w[1] + w[2], 1, 1e-9);
    }

  // Sides: each curve bounds a face on either side, once; cycles close up.
  std::vector<std::array<int, 2>> seen(l.curves.size(), {0, 0});
  int total = 0;
  for (int f = 0; f < static_cast<int>(l.faces.size()); ++f) {
    total += l.faces[f].euler;
    for (const auto& cycle : l.faces[f].cycles)
      for (std::size_t k = 0; k < cycle.size(); ++k) {
        const PatchLayout::Side &s = cycle[k], &next = cycle[(k + 1) % cycle.size()];
        ++seen[s.curve][s.forward];
        EXPECT_EQ(l.start({s.curve, !s.forward}), l.start(next));
        const std::vector<int> points = l.points(s);
        EXPECT_EQ(l.face[half_edge.at({points[0], points[1]}) / 3], f);
      }
  }
  for (std::size_t c = 0; c < seen.size(); ++c) EXPECT_EQ(seen[c], (std::array<int, 2>{l.curves[c].boundary ? 0 : 1, 1}));
  // Euler number of the surface: the faces', glued along curves at nodes.
  long euler = static_cast<long>(surface.points.size()) + static_cast<long>(surface.faces.size());
  long halves = 0, open = 0;
  for (const int o : surface.opposite) ++halves, open += o < 0;
  euler -= (halves + open) / 2;
  EXPECT_EQ(total - static_cast<long>(l.curves.size()) + static_cast<long>(l.nodes.size()), euler);
}

inline void expect_maps(const TriangleSurface& surface, const PatchLayout& layout) {
  ASSERT_TRUE(layout.is_quads());
  PatchedSurface patched = to_patched_surface(layout);
  expect_layout(surface, patched);
  Context context;
  const auto corners = map_patches(patched, Progress(context));
  for (const auto& c : corners) {
    const Vec2 a = c[1] - c[0], b = c[2] - c[0];
    EXPECT_GT(a.x() * b.y() - a.y() * b.x(), 0);
  }
}

}  // namespace hybrid_mesh::testing
