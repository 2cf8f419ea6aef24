// SPDX-License-Identifier: GPL-3.0-or-later
#include "topology/loop_cap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "closed_and_opened.h"
#include "topology/patch_hits.h"

namespace hybrid_mesh {
namespace {

using namespace testing;

// Of all corners, in degrees, ascending.
std::vector<double> angles_of(const TriangleSurface& s) {
  std::vector<double> angles;
  for (const auto& face : s.faces)
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = s.points[face[(k + 1) % 3]] - s.points[face[k]], v = s.points[face[(k + 2) % 3]] - s.points[face[k]];
      angles.push_back(std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / std::numbers::pi);
    }
  std::sort(angles.begin(), angles.end());
  return angles;
}

// A patch as a surface of its own: simplicial, manifold, and its faces run along the rims in their direction.
TriangleSurface surface_of(const std::vector<Vec3>& rim, const RimPatch& patch) {
  TriangleSurface s;
  s.points = rim;
  s.points.insert(s.points.end(), patch.points.begin(), patch.points.end());
  s.faces = patch.faces;
  finish(s);
  expect_manifold(s);
  return s;
}

std::vector<Vec3> ellipse(int n, double a, double b, double wave = 0) {
  std::vector<Vec3> rim;
  for (int i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * i / n;
    rim.push_back(Vec3(a * std::cos(t), b * std::sin(t), wave * std::sin(2 * t)));
  }
  return rim;
}

void expect_cap(const std::vector<Vec3>& rim, double least_angle) {
  const RimPatch cap = cap_loop(rim);
  const TriangleSurface s = surface_of(rim, cap);
  const TopologySummary summary = summarize_topology(to_soup(s));
  EXPECT_EQ(summary.euler, 1);
  EXPECT_EQ(summary.boundary_loops, 1);
  const int n = static_cast<int>(rim.size());
  std::set<int> along;
  for (int h = 0; h < static_cast<int>(s.opposite.size()); ++h) {
    const int a = s.from(h), b = s.to(h);
    if (s.opposite[h] < 0) {
      EXPECT_EQ((a + 1) % n, b);
      along.insert(a);
    } else {
      EXPECT_FALSE(a < n && b < n);
    }
  }
  EXPECT_EQ(along.size(), rim.size());
  EXPECT_GE(angles_of(s)[0], least_angle);
}

TEST(LoopCap, OfRoundRims) {
  for (const int n : {3, 4, 5, 6, 7, 8, 9, 10, 12, 16, 24, 50, 100, 300}) {
    SCOPED_TRACE(n);
    expect_cap(ellipse(n, 1, 1), 20);
  }
}

TEST(LoopCap, OfRimsThatAreNotRoundOrPlanar) {
  expect_cap(ellipse(60, 1, 0.3), 12);
  expect_cap(ellipse(60, 1, 1, 0.7), 12);
  expect_cap(ellipse(40, 1, 0.5, 1.5), 8);
  expect_cap(ellipse(200, 5, 0.5), 5);
}

TEST(LoopCap, OfSidesOfVeryDifferentLength) {
  std::vector<Vec3> rim;
  for (int i = 0; i < 40; ++i) {
    const double u = i / 40.0, t = 2 * std::numbers::pi * u * u * u;
    rim.push_back(Vec3(std::cos(t), std::sin(t), 0));
  }
  expect_cap(rim, 0);
}

TEST(LoopCap, OfRimsWithoutExtent) {
  expect_cap(std::vector<Vec3>(7, Vec3(1, 2, 3)), 0);
  std::vector<Vec3> line;
  for (int i = 0; i < 12; ++i) line.push_back(Vec3(i < 6 ? i : 11 - i, 0, 0));
  expect_cap(line, 0);
}

TEST(LoopCap, HasTrianglesAsLargeAsTheRimsSides) {
  const auto rim = ellipse(40, 1, 1);
  const double side = (rim[1] - rim[0]).norm();
  const TriangleSurface s = surface_of(rim, cap_loop(rim));
  const double mean = std::numbers::pi / static_cast<double>(s.faces.size());
  EXPECT_GT(mean, 0.7 * side * side * std::sqrt(3.0) / 4);
  EXPECT_LT(mean, 3 * side * side * std::sqrt(3.0) / 4);
  // Of a long rim it takes a number of triangles in proportion to its sides, not to their square.
  EXPECT_LT(cap_loop(ellipse(1000, 1, 1)).faces.size(), 12000u);
}

TEST(LoopCap, TubesOfAnyNumbersOfSides) {
  for (const int n : {3, 5, 40})
    for (const int m : {3, 8, 41})
      for (const double length : {0.01, 1.0, 5.0}) {
        std::vector<Vec3> first = ellipse(n, 1, 1), second = ellipse(m, 0.6, 0.8, 0.1);
        for (Vec3& p : second) p.z() += length;
        std::reverse(second.begin(), second.end());
        const RimPatch tube = tube_between(first, second, 2);
        std::vector<Vec3> rims = first;
        rims.insert(rims.end(), second.begin(), second.end());
        const TriangleSurface s = surface_of(rims, tube);
        const TopologySummary summary = summarize_topology(to_soup(s));
        EXPECT_EQ(summary.euler, 0);
        EXPECT_EQ(summary.boundary_loops, 2);
        EXPECT_EQ(summary.components, 1);
        for (int h = 0; h < static_cast<int>(s.opposite.size()); ++h) {
          if (s.opposite[h] >= 0) continue;
          const int a = s.from(h), b = s.to(h);
          EXPECT_EQ(b, a < n ? (a + 1) % n : n + (a - n + 1) % m);
        }
      }
}

// A tall bump stands in the way of the shortest loop's disk through the hole of a torus.
TEST(LoopDetour, AvoidsWhatACapWouldHit) {
  PolygonSoup soup = torus(48, 48, 0.8, 0);
  add(soup, ball(8, 2, Vec3(0, 0, 0), 0.1));  // a ball that floats in the hole's middle
  const TriangleSurface s = repaired(soup);
  Context context;
  const PatchHits hits(s, Progress(context));
  const auto hits_of = [&](const SurfaceLoop& loop) {
    std::vector<Vec3> rim;
    for (const int v : loop.points) rim.push_back(s.points[v]);
    return hits.count(loop.points, cap_loop(rim), {}, 1000);
  };
  LoopOptions direct;
  direct.detour = 1;
  const auto shortest = loops_of(s, {}, direct), clear = loops_of(s);
  ASSERT_EQ(shortest.size(), 1u);
  ASSERT_EQ(clear.size(), 1u);
  EXPECT_GT(hits_of(shortest[0]), 0);
  EXPECT_LT(hits_of(clear[0]), hits_of(shortest[0]));
  EXPECT_LE(clear[0].length, 1.5 * shortest[0].length);
}

}  // namespace
}  // namespace hybrid_mesh
