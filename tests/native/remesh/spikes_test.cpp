// SPDX-License-Identifier: GPL-3.0-or-later
// Features much longer than wide: they are mapped without degenerating, and their tips are kept.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <tuple>

#include "remesh/remesh.h"
#include "soundness.h"

namespace hybrid_mesh {
namespace {

// A grid of rows x columns points, closed around in both directions or with a pole at either end.
PolygonSoup grid(int rows, int columns, bool torus, const std::function<Vec3(int, int)>& place) {
  PolygonSoup soup;
  const auto add = [&](std::initializer_list<int> face) {
    for (const int v : face) soup.indices.push_back(v);
    soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
  };
  if (soup.offsets.empty()) soup.offsets.push_back(0);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) soup.points.push_back(place(i, j));
  for (int i = 0; i + (torus ? 0 : 1) < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const int k = (i + 1) % rows, l = (j + 1) % columns;
      add({i * columns + j, k * columns + j, k * columns + l});
      add({i * columns + j, k * columns + l, i * columns + l});
    }
  if (torus) return soup;
  const auto pole = [&](int row, bool first) {
    Vec3 middle = Vec3::Zero();
    for (int j = 0; j < columns; ++j) middle += soup.points[row * columns + j] / columns;
    soup.points.push_back(middle);
    for (int j = 0; j < columns; ++j) {
      const int a = row * columns + j, b = row * columns + (j + 1) % columns, p = static_cast<int>(soup.points.size()) - 1;
      first ? add({p, a, b}) : add({p, b, a});
    }
  };
  pole(0, true);
  pole(rows - 1, false);
  return soup;
}

// A ball with a rod of 30 times its width.
PolygonSoup rod() {
  const double r = 0.1, length = 6, z0 = std::sqrt(1 - r * r), a0 = std::asin(r);
  std::vector<Vec2> profile;
  for (int i = 1; i < 6; ++i)
    profile.push_back(Vec2(r * std::sin(std::numbers::pi / 12 * i), z0 + length - r + r * std::cos(std::numbers::pi / 12 * i)));
  for (int i = 0; i < 120; ++i) profile.push_back(Vec2(r, z0 + length - r - (length - r) * i / 120));
  for (int i = 0; i < 39; ++i)
    profile.push_back(Vec2(std::sin(a0 + (std::numbers::pi - a0) * i / 40), std::cos(a0 + (std::numbers::pi - a0) * i / 40)));
  return grid(static_cast<int>(profile.size()), 24, false, [&](int i, int j) {
    const double a = 2 * std::numbers::pi * j / 24;
    return Vec3(profile[i].x() * std::cos(a), profile[i].x() * std::sin(a), profile[i].y());
  });
}

// Of 60 times its width and nothing else.
PolygonSoup bare_rod() {
  return grid(400, 20, false, [](int i, int j) {
    const double a = 2 * std::numbers::pi * j / 20, end = std::min({1.0, (i + 1) / 6.0, (400 - i) / 6.0});
    return Vec3(0.5 * end * std::cos(a), 0.5 * end * std::sin(a), 60.0 * i / 399);
  });
}

// Pulls a point out along a direction where it is near a foot.
Vec3 pulled(const Vec3& p, const Vec3& foot, const Vec3& direction) {
  return p + 1.5 * std::exp(-(p - foot).squaredNorm() / (0.06 * 0.06)) * direction;
}

PolygonSoup torus_with_a_spike() {
  return grid(300, 120, true, [](int i, int j) {
    const double a = 2 * std::numbers::pi * i / 300, b = 2 * std::numbers::pi * j / 120;
    const Vec3 p((1 + 0.35 * std::cos(b)) * std::cos(a), (1 + 0.35 * std::cos(b)) * std::sin(a), 0.35 * std::sin(b));
    return pulled(p, Vec3(1.35, 0, 0), Vec3::UnitX());
  });
}

PolygonSoup two_spikes() {
  return grid(199, 300, false, [](int i, int j) {
    const double b = std::numbers::pi * (i + 1) / 200, a = 2 * std::numbers::pi * j / 300;
    const Vec3 p(std::sin(b) * std::cos(a), std::sin(b) * std::sin(a), std::cos(b));
    const Vec3 x = Vec3::UnitX(), y(std::cos(0.3), std::sin(0.3), 0);
    return pulled(pulled(p, x, x), y, y);
  });
}

void expect_kept(const PolygonSoup& soup) {
  RemeshOptions options;
  options.vertices = 6000;
  options.refinement = Refinement::Adaptive;
  options.base = BaseSize::Minimal;
  Context context;
  const RemeshResult r = remesh(soup, options, context);
  testing::expect_sound(r);
  EXPECT_LE(r.report["final"]["hausdorff"].get<double>(), 0.01);
  testing::expect_maps_without_defects(r.hierarchy);
}

TEST(Spikes, ARodIsKept) { expect_kept(rod()); }
TEST(Spikes, OneOnATorusIsKept) { expect_kept(torus_with_a_spike()); }
TEST(Spikes, TwoSideBySideAreKept) { expect_kept(two_spikes()); }

// A base that has too few quads to go around would shear all of them.
TEST(Spikes, ABareRodHasSquareQuads) {
  RemeshOptions options;
  options.vertices = 3000;
  Context context;
  const RemeshResult r = remesh(bare_rod(), options, context);
  testing::expect_sound(r);
  EXPECT_GE(r.report["final"]["scaled_jacobian"]["p50"].get<double>(), 0.9);
  const double area = std::numbers::pi / 60;  // of unit length
  EXPECT_GE(r.report["base"]["quads"].get<double>(), 3 * 3 / area);
}

// A closed box of n x n quads a side, of height 1 but for its thickness along z.
PolygonSoup thin_box(int n, double thickness) {
  PolygonSoup soup;
  std::map<std::tuple<int, int, int>, std::int32_t> at;
  const auto corner = [&](int axis, int side, int i, int j) {
    int k[3];
    k[axis] = side * n, k[(axis + 1) % 3] = i, k[(axis + 2) % 3] = j;
    const auto [found, fresh] = at.try_emplace({k[0], k[1], k[2]}, static_cast<std::int32_t>(soup.points.size()));
    if (fresh) soup.points.emplace_back(static_cast<double>(k[0]) / n, static_cast<double>(k[1]) / n, thickness * k[2] / n);
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, 1})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const int d = side ? 0 : 1;  // outwards
          for (const auto& [x, y] : {std::pair(0, 0), std::pair(1 - d, d), std::pair(1, 1), std::pair(d, 1 - d)})
            soup.indices.push_back(corner(axis, side, i + x, j + y));
          soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
        }
  return soup;
}

// Its sides are far lower than quads are wide, and those between their edges are folded.
TEST(Spikes, ASheetWithoutThicknessIsNoWreck) {
  RemeshOptions options;
  options.vertices = 2000;
  Context context;
  const RemeshResult r = remesh(thin_box(30, 1e-5), options, context);
  testing::expect_sound(r);
  const double width = std::sqrt(1 / 2000.0);
  EXPECT_LE(r.report["final"]["hausdorff"].get<double>(), width);
  EXPECT_LE(r.report["final"]["l2"].get<double>(), 0.1 * width);
  EXPECT_LE(r.report["final"]["scaled_jacobian"]["inverted"].get<double>(), 0.02);
}

}  // namespace
}  // namespace hybrid_mesh
