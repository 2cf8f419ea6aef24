// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/drawn_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "drawn_checks.h"
#include "drawn_strokes.h"
#include "layout_checks.h"
#include "models.h"

namespace hybrid_mesh {
namespace {

using testing::all_messages;
using testing::ball;
using testing::count;
using testing::cube_strokes;
using testing::expect_maps;
using testing::expect_origins;
using testing::expect_sound;
using testing::face_sizes;
using testing::jitter;
using testing::layout_of;
using testing::repaired;
using testing::sphere;
using testing::torus;
using testing::unit;
using Kind = LayoutProblem::Kind;

std::vector<DrawnStroke> sphere_cube(double gap, double noise, std::uint64_t seed, double radius = 1) {
  return cube_strokes([&](const Vec3& d) { return Vec3(radius * d.normalized()); }, 6, gap, noise, seed);
}

TEST(DrawnLayout, TheEdgesOfACubeDrawnRoughlyAreSixQuads) {
  for (const int n : {1, 3, 12, 40}) {
    const TriangleSurface surface = unit(sphere(n));
    const double radius = surface.points[0].norm();
    for (int seed = 0; seed < (n == 12 ? 30 : 4); ++seed) {
      SCOPED_TRACE(std::to_string(n) + " " + std::to_string(seed));
      DrawnLayoutOptions options;
      if (n < 12) options.reach = 0.3;
      const DrawnLayout d = layout_of(surface, sphere_cube(0.02, 0.008, seed, radius), options);
      expect_sound(surface, d.layout);
      EXPECT_EQ(all_messages(d), "");
      EXPECT_EQ(d.layout.nodes.size(), 8u);
      EXPECT_EQ(d.layout.curves.size(), 12u);
      EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 4, 4, 4, 4}));
      if (d.layout.is_quads()) expect_maps(surface, d.layout);
    }
  }
}

TEST(DrawnLayout, TheSameOnScans) {
  if (real_models().empty()) GTEST_SKIP() << no_models();
  for (const auto& path : real_models()) {
    const TriangleSurface surface = unit(repaired(read_polygon_soup(path.string())));
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : surface.points) centre += p / static_cast<double>(surface.points.size());
    // What lies in a direction from the centre: not continuous where the surface is hidden by itself.
    const auto place = [&](const Vec3& d) {
      const Vec3* best = nullptr;
      double cosine = -2;
      for (const Vec3& p : surface.points)
        if (const double c = (p - centre).normalized().dot(d.normalized()); c > cosine) cosine = c, best = &p;
      return *best;
    };
    SCOPED_TRACE(path.stem().string());
    const DrawnLayout d = layout_of(surface, cube_strokes(place, 12, 0.02, 0.008, 1));
    expect_sound(surface, d.layout);
    if (std::set<std::string>{"bunny", "mannequin", "max_planck"}.count(path.stem().string())) {
      EXPECT_EQ(all_messages(d), "");
      EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 4, 4, 4, 4}));
      if (d.layout.is_quads()) expect_maps(surface, d.layout);
    }
  }
}

TEST(DrawnLayout, ACurveThatEndsNowhereIsNamedWithItsPlace) {
  const TriangleSurface surface = unit(sphere(16));
  const double radius = surface.points[0].norm();
  std::vector<DrawnStroke> strokes = sphere_cube(0, 0, 1, radius);
  const Vec3 free_end = radius * Vec3(0.1, 0.2, 1).normalized();
  strokes.push_back({{radius * Vec3(-0.2, 0.98, 1).normalized(), radius * Vec3(0, 0.5, 1).normalized(), free_end}});
  const DrawnLayout d = layout_of(surface, strokes);
  expect_sound(surface, d.layout);
  ASSERT_EQ(count(d, Kind::Dangling), 1) << all_messages(d);
  const auto problem = std::find_if(d.problems.begin(), d.problems.end(), [](const LayoutProblem& p) { return p.kind == Kind::Dangling; });
  EXPECT_EQ(problem->stroke, 12);
  ASSERT_EQ(problem->where.size(), 1u);
  EXPECT_LT((problem->where[0] - free_end).norm(), 0.01);
  // It begins on an edge of the cube, and gives the face on the other side a fifth side.
  EXPECT_EQ(count(d, Kind::OddSides), 1);
  EXPECT_EQ(d.problems.size(), 2u) << all_messages(d);
}

TEST(DrawnLayout, AFigureOfEightCrossesItself) {
  const TriangleSurface surface = unit(sphere(16));
  const double radius = surface.points[0].norm();
  DrawnStroke eight;
  for (int i = 0; i <= 60; ++i) {
    const double a = 2 * std::numbers::pi * (i + 7.5) / 60;
    eight.points.push_back(radius * Vec3(0.7 * std::sin(a), 0.5 * std::sin(2 * a), 1).normalized());
  }
  const DrawnLayout d = layout_of(surface, {eight});
  expect_sound(surface, d.layout);
  EXPECT_EQ(d.layout.nodes.size(), 1u);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{1, 1, 2}));
  EXPECT_EQ(count(d, Kind::TooFewSides), 3);
}

TEST(DrawnLayout, LoopsOnATorusAndACylinder) {
  const auto on_torus = [](double a, double b) {
    return Vec3((1 + 0.4 * std::cos(b)) * std::cos(a), (1 + 0.4 * std::cos(b)) * std::sin(a), 0.4 * std::sin(b));
  };
  DrawnStroke around, across;
  for (int i = 0; i <= 40; ++i) {
    around.points.push_back(on_torus(0.3 + 2 * std::numbers::pi * i / 40, 0.1));
    across.points.push_back(on_torus(1, 2 + 2 * std::numbers::pi * i / 40));
  }
  const TriangleSurface ring = repaired(torus(40, 20, 0.4, 0));
  DrawnLayout d = layout_of(ring, {around, across});
  expect_sound(ring, d.layout);
  EXPECT_EQ(count(d, Kind::TouchesItself), 1);
  EXPECT_EQ(d.layout.nodes.size(), 1u);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4}));
  d = layout_of(ring, {across});
  expect_sound(ring, d.layout);
  EXPECT_EQ(count(d, Kind::NotADisk), 1);
  // Marked on the face, from rim to rim: all around the torus, from one side of the curve at the angle 1 to the other.
  for (const LayoutProblem& p : d.problems) {
    double turn = 0;
    for (std::size_t i = 1; i < p.where.size(); ++i)
      turn += std::atan2(p.where[i - 1].cross(p.where[i]).z(), p.where[i - 1].head<2>().dot(p.where[i].head<2>()));
    EXPECT_NEAR(std::abs(turn), 2 * std::numbers::pi, 0.5);
  }

  const TriangleSurface cylinder = repaired(glued_rectangle(24, 8, false, false));
  DrawnStroke along;
  for (int i = 0; i <= 10; ++i) along.points.push_back(Vec3(2 + 0.2 * i, 0.3, 0.02));
  d = layout_of(cylinder, {along});
  expect_sound(cylinder, d.layout);
  EXPECT_EQ(count(d, Kind::TouchesItself), 1);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4}));
  DrawnStroke opposite = along;
  for (Vec3& p : opposite.points) p.x() *= -1;
  d = layout_of(cylinder, {along, opposite});
  expect_sound(cylinder, d.layout);
  EXPECT_EQ(all_messages(d), "");
  expect_maps(cylinder, d.layout);
  d = layout_of(cylinder, {});
  expect_sound(cylinder, d.layout);
  EXPECT_EQ(count(d, Kind::NotADisk), 1);
}

TEST(DrawnLayout, ARingIsMarkedWhereItIs) {
  // Circles at the heights 0.9 and -0.1: a cap, a ring, and a bowl.
  const TriangleSurface surface = unit(sphere(20));
  const double radius = surface.points[0].norm();
  std::vector<DrawnStroke> circles(2);
  const double heights[2] = {0.9, -0.1};
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i <= 40; ++i) {
      const double a = 2 * std::numbers::pi * i / 40, z = heights[k];
      circles[k].points.push_back(radius * Vec3(std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z));
      circles[k].fit = DrawnStroke::Fit::AsDrawn;
    }
  const DrawnLayout d = layout_of(surface, circles);
  ASSERT_EQ(count(d, Kind::NotADisk), 1);
  for (const LayoutProblem& p : d.problems) {
    if (p.kind != Kind::NotADisk) continue;
    ASSERT_GE(p.where.size(), 2u);
    for (const Vec3& x : p.where) {
      EXPECT_GT(x.z() / radius, -0.15);
      EXPECT_LT(x.z() / radius, 0.95);
      EXPECT_GT(x.norm(), 0.95 * radius);
    }
    EXPECT_NEAR(std::abs(p.where.front().z() - p.where.back().z()) / radius, 1.0, 0.05);
    // Not around: the way is no longer than it has to be.
    EXPECT_LT((p.where.front() - p.where.back()).norm(), 1.6 * radius);
  }
}

TEST(DrawnLayout, WhatRunsFarFromTheShortestWayStaysAsDrawn) {
  const TriangleSurface surface = unit(sphere(24));
  const double radius = surface.points[0].norm();
  // The edges of a cube, one of them an arc that leaves the shortest way by `bulge` times its length; twelve of them, six quads.
  for (const double bulge : {0.05, 0.4}) {
    std::vector<DrawnStroke> strokes = sphere_cube(0, 0, 1, radius);
    DrawnStroke& arc = strokes[0];
    const Vec3 start = arc.points.front(), end = arc.points.back();
    const Vec3 side = start.cross(end).normalized(), middle = radius * (0.5 * (start + end) + bulge * (end - start).norm() * side).normalized();
    arc.points.clear();
    for (int i = 0; i <= 40; ++i) {
      const double t = i / 40.0;
      const Vec3 bow = 4 * t * (1 - t) * bulge * (end - start).norm() * side;
      arc.points.push_back(radius * ((1 - t) * start + t * end + bow).normalized());
    }
    const DrawnLayout d = layout_of(surface, strokes);
    expect_sound(surface, d.layout);
    EXPECT_EQ(all_messages(d), "");
    double nearest = 1;
    for (const PatchLayout::Curve& c : d.layout.curves)
      for (const int v : c.points) nearest = std::min(nearest, (d.layout.mesh.points[v] - middle).norm() / radius);
    if (bulge < 0.1)
      EXPECT_GT(nearest, 0.04);  // tight
    else
      EXPECT_LT(nearest, 0.04);
  }
}

TEST(DrawnLayout, ComponentsApart) {
  PolygonSoup soup = ball(8);
  testing::add(soup, ball(8, 2, Vec3(3, 0, 0)));
  const TriangleSurface surface = repaired(soup);
  DrawnStroke across;
  for (int i = 0; i <= 20; ++i) across.points.push_back(Vec3(3 * i / 20.0, 0, 1.02));
  DrawnLayoutOptions options;
  options.reach = 0.5;
  DrawnLayout d = layout_of(surface, {across}, options);
  expect_sound(surface, d.layout);
  EXPECT_EQ(count(d, Kind::Disconnected), 1);
  EXPECT_EQ(count(d, Kind::Uncovered), 2);
}

TEST(DrawnLayout, WhateverIsScribbledTheLayoutIsSound) {
  const std::vector<TriangleSurface> surfaces{
      unit(sphere(8)),        unit(repaired(ball(7, 0.2))), unit(repaired(torus(18, 9))),
      unit(repaired(cube())), unit(repaired(grid(6, 6))),   unit(repaired(glued_rectangle(12, 5, false, false)))};
  for (int seed = 0; seed < 300; ++seed) {
    TestRandom random(seed);
    const TriangleSurface& surface = surfaces[seed % surfaces.size()];
    std::vector<DrawnStroke> strokes;
    const int strokes_count = 1 + random.below(8);
    for (int k = 0; k < strokes_count; ++k) {
      DrawnStroke s;
      Vec3 p = surface.points[random.below(static_cast<int>(surface.points.size()))];
      Vec3 way = jitter(random, 0.2);
      const int length = 2 + random.below(20), kind = random.below(8);
      for (int i = 0; i < length; ++i) {
        s.points.push_back(p);
        way += jitter(random, kind < 4 ? 0.02 : 0.1);
        p += (kind == 7 ? 3 : 0.5) * way;
        // Most stay near.
        if (kind < 6) p = p.normalized() * std::min(p.norm(), 0.5);
      }
      if (kind == 3 && !strokes.empty()) s.points.back() = strokes[0].points[strokes[0].points.size() / 2];
      if (kind == 2) s.points.push_back(s.points[0]);
      s.fit = random.below(2) ? DrawnStroke::Fit::Tight : DrawnStroke::Fit::AsDrawn;
      strokes.push_back(s);
    }
    SCOPED_TRACE(seed);
    DrawnLayoutOptions options;
    options.snap = random.below(5) == 0 ? 0.1 : random.below(5) == 0 ? 0.002 : 0.02;
    options.reach = 0.6;
    const DrawnLayout d = layout_of(surface, strokes, options);
    expect_sound(surface, d.layout);
    expect_origins(d, strokes_count);
    if (::testing::Test::HasFatalFailure()) return;
    if (d.problems.empty() && d.layout.is_quads()) expect_maps(surface, d.layout);
  }
}

}  // namespace
}  // namespace hybrid_mesh
