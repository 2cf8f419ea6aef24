// SPDX-License-Identifier: GPL-3.0-or-later
// Strokes as they are drawn by hand: coarse, beside the surface, with gaps and overshoots.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "generated_surfaces.h"
#include "layout/drawn/drawn_layout.h"
#include "shapes.h"

namespace hybrid_mesh::testing {

inline TriangleSurface sphere(int n) {
  PolygonSoup soup = ball(n);
  for (Vec3& p : soup.points) p.normalize();
  return repaired(soup);
}

inline double diagonal(const TriangleSurface& s) {
  Vec3 low = s.points[0], high = s.points[0];
  for (const Vec3& p : s.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).norm();
}

inline Vec3 jitter(TestRandom& random, double size) {
  return size * Vec3(2 * random.unit() - 1, 2 * random.unit() - 1, 2 * random.unit() - 1) / std::sqrt(3.0);
}

// A polyline of `pieces` pieces along curve(0) .. curve(1), going on or ending early by up to `gap` (a fraction of it), every point off by up to
// `noise`.
inline DrawnStroke stroke(const std::function<Vec3(double)>& curve, int pieces, double gap, double noise, TestRandom& random) {
  DrawnStroke s;
  const double from = gap * (2 * random.unit() - 1), to = 1 + gap * (2 * random.unit() - 1);
  for (int i = 0; i <= pieces; ++i) s.points.push_back(curve(from + (to - from) * i / pieces) + jitter(random, noise));
  return s;
}

// A line as a stroke: a point every `spacing`, each off by up to `noise`; it begins and ends up to `gap` early, or goes on.
inline DrawnStroke redrawn(const std::vector<Vec3>& line, double spacing, double noise, double gap, TestRandom& random) {
  std::vector<double> at{0};
  for (std::size_t i = 1; i < line.size(); ++i) at.push_back(at.back() + (line[i] - line[i - 1]).norm());
  const auto point = [&](double s) {
    std::size_t i = 1;
    while (i + 1 < line.size() && at[i] < s) ++i;
    const double part = at[i] - at[i - 1];
    return Vec3(line[i - 1] + (part > 0 ? (s - at[i - 1]) / part : 0) * (line[i] - line[i - 1]));
  };
  const double from = gap * (2 * random.unit() - 1), to = at.back() + gap * (2 * random.unit() - 1);
  const int pieces = std::max(2, static_cast<int>((to - from) / spacing));
  DrawnStroke s;
  for (int i = 0; i <= pieces; ++i) s.points.push_back(point(from + (to - from) * i / pieces) + jitter(random, noise));
  return s;
}

inline const std::vector<std::pair<int, int>>& cube_edges() {
  static const std::vector<std::pair<int, int>> edges{{0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  return edges;
}

// The edges of a cube around `centre`, thrown on the surface from there: place(direction).
inline std::vector<DrawnStroke> cube_strokes(const std::function<Vec3(const Vec3&)>& place, int pieces, double gap, double noise,
                                             std::uint64_t seed) {
  TestRandom random(seed);
  std::vector<DrawnStroke> strokes;
  const auto corner = [](int i) { return Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1); };
  for (const auto& [a, b] : cube_edges())
    strokes.push_back(
        stroke([&, a = a, b = b](double t) { return place(Vec3(corner(a) + t * (corner(b) - corner(a)))); }, pieces, gap, noise, random));
  return strokes;
}

inline DrawnLayout layout_of(const TriangleSurface& surface, const std::vector<DrawnStroke>& strokes, const DrawnLayoutOptions& options = {}) {
  Context context;
  return make_layout(surface, strokes, options, Progress(context));
}

}  // namespace hybrid_mesh::testing
