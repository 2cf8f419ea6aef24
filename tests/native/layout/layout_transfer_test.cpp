// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/drawn/layout_transfer.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "drawn_strokes.h"
#include "layout/base/base_domain.h"
#include "layout_checks.h"
#include "models.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::expect_maps;
using testing::expect_sound;
using testing::repaired;
using testing::torus;
using testing::unit;

LayoutOutline outline_of(const PatchedSurface& base, bool with_sides) {
  LayoutOutline outline;
  outline.nodes.resize(base.node_count);
  outline.quads = base.nodes;
  outline.neighbours = base.neighbours;
  if (with_sides) outline.sides.resize(base.patch_count());
  for (int q = 0; q < base.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) {
      outline.nodes[base.nodes[q][i]] = base.mesh.points[base.sides[q][i].front()];
      if (!with_sides) continue;
      for (const int v : base.sides[q][i]) outline.sides[q][i].push_back(base.mesh.points[v]);
    }
  return outline;
}

PatchedSurface base_of(const TriangleSurface& surface, double size) {
  Context context;
  BaseDomainOptions options;
  options.size = size;
  return BaseDomain(surface, {}, options, Progress(context)).cut(testing::whole_surface, Progress(context)).patches;
}

TransferredLayout transferred(const TriangleSurface& surface, const LayoutOutline& outline) {
  Context context;
  return transfer_layout(surface, outline, Progress(context));
}

// The faces are the quads, with their neighbours.
void expect_quads(const PatchLayout& layout, const LayoutOutline& outline) {
  ASSERT_EQ(layout.faces.size(), outline.quads.size());
  ASSERT_EQ(layout.nodes.size(), outline.nodes.size());
  ASSERT_TRUE(layout.is_quads());
  const PatchedSurface patched = to_patched_surface(layout);
  EXPECT_EQ(patched.nodes, outline.quads);
  for (std::size_t q = 0; q < outline.neighbours.size(); ++q)
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(patched.neighbours[q][i].patch, outline.neighbours[q][i].patch);
      if (outline.neighbours[q][i].patch >= 0) {
        EXPECT_EQ(patched.neighbours[q][i].side, outline.neighbours[q][i].side);
      }
    }
}

TEST(LayoutTransfer, FromACoarseTriangulationToAFineOne) {
  PolygonSoup two = ball(8), two_fine = ball(20);
  testing::add(two, ball(6, 2, Vec3(3, 0, 0), 0.5));
  testing::add(two_fine, ball(13, 2, Vec3(3, 0, 0), 0.5));
  const std::vector<std::pair<PolygonSoup, PolygonSoup>> shapes{
      {ball(8), ball(25)}, {torus(24, 12), torus(61, 33)}, {ball(9, 0.3), ball(22, 0.3)}, {two, two_fine}, {grid(6, 6), grid(6, 6)}};
  for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
    const TriangleSurface coarse = unit(repaired(shapes[shape].first)), fine = unit(repaired(shapes[shape].second));
    for (const double size : {1, 12, 40})
      for (const bool with_sides : {false, true}) {
        SCOPED_TRACE(std::to_string(shape) + " " + std::to_string(size));
        const LayoutOutline outline = outline_of(base_of(coarse, size), with_sides);
        const TransferredLayout t = transferred(fine, outline);
        ASSERT_EQ(t.failure, "");
        expect_sound(fine, t.layout);
        expect_quads(t.layout, outline);
        for (std::size_t n = 0; n < outline.nodes.size(); ++n) EXPECT_LT((t.layout.mesh.points[t.layout.nodes[n]] - outline.nodes[n]).norm(), 0.1);
        if (find_problems(t.layout).empty()) expect_maps(fine, t.layout);
      }
  }
}

TEST(LayoutTransfer, ADrawnLayoutOnOtherTriangulations) {
  const TriangleSurface coarse = unit(testing::sphere(5)), fine = unit(testing::sphere(31));
  const double radius = coarse.points[0].norm();
  const DrawnLayout drawn =
      testing::layout_of(coarse, testing::cube_strokes([&](const Vec3& d) { return Vec3(radius * d.normalized()); }, 6, 0.02, 0.005, 3));
  ASSERT_TRUE(drawn.problems.empty());
  const PatchedSurface patched = to_patched_surface(drawn.layout);
  LayoutOutline outline = outline_of(patched, false);
  outline.neighbours.clear();
  const TransferredLayout t = transferred(fine, outline);
  ASSERT_EQ(t.failure, "");
  expect_sound(fine, t.layout);
  expect_quads(t.layout, outline);
  expect_maps(fine, t.layout);
  // Geodesics: on a sphere, arcs of great circles.
  for (const PatchLayout::Curve& c : t.layout.curves) {
    double length = 0;
    for (std::size_t k = 1; k < c.points.size(); ++k) length += (t.layout.mesh.points[c.points[k]] - t.layout.mesh.points[c.points[k - 1]]).norm();
    const Vec3 a = t.layout.mesh.points[c.points.front()], b = t.layout.mesh.points[c.points.back()];
    EXPECT_LT(length, 1.003 * radius * std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  // To itself: nodes that are vertices stay there.
  const TransferredLayout again = transferred(fine, outline_of(to_patched_surface(t.layout), true));
  EXPECT_EQ(again.failure, "");
}

TEST(LayoutTransfer, ManyCurvesThroughFewTriangles) {
  const TriangleSurface fine = unit(testing::sphere(12));
  int done = 0;
  for (const int n : {1, 2, 4}) {
    const TriangleSurface coarse = unit(testing::sphere(n));
    for (const double size : {6, 20, 60}) {
      SCOPED_TRACE(std::to_string(n) + " " + std::to_string(size));
      const LayoutOutline outline = outline_of(base_of(fine, size), false);
      const TransferredLayout t = transferred(coarse, outline);
      if (!t.failure.empty()) continue;
      ++done;
      expect_sound(coarse, t.layout);
      expect_quads(t.layout, outline);
    }
  }
  EXPECT_GE(done, 6);
}

TEST(LayoutTransfer, ScansGetTheirOwnLayoutsAgain) {
  if (real_models().empty()) GTEST_SKIP() << no_models();
  for (const auto& path : real_models()) {
    SCOPED_TRACE(path.stem().string());
    const TriangleSurface surface = unit(repaired(read_polygon_soup(path.string())));
    const LayoutOutline outline = outline_of(base_of(surface, 60), true);
    const TransferredLayout t = transferred(surface, outline);
    if (std::set<std::string>{"armadillo", "bunny", "bunny_holes", "feline", "fertility", "horse", "mannequin_open"}.count(path.stem().string())) {
      EXPECT_EQ(t.failure, "");
    }
    if (!t.failure.empty()) continue;
    expect_sound(surface, t.layout);
    expect_quads(t.layout, outline);
  }
}

TEST(LayoutTransfer, WhatCannotBeIsSaidInWords) {
  const TriangleSurface sphere = unit(repaired(ball(10))), ring = unit(repaired(torus(24, 12))), cap = unit(repaired(ball(10, 0.3)));
  const auto failure = [](const TriangleSurface& surface, const LayoutOutline& outline) {
    const TransferredLayout t = transferred(surface, outline);
    EXPECT_TRUE(t.layout.faces.empty());
    return t.failure;
  };
  const LayoutOutline of_ring = outline_of(base_of(ring, 30), false), of_cap = outline_of(base_of(cap, 30), false),
                      of_sphere = outline_of(base_of(sphere, 30), false);
  EXPECT_NE(failure(sphere, of_ring).find("Euler number 2"), std::string::npos);
  EXPECT_NE(failure(ring, of_sphere).find("Euler number 0"), std::string::npos);
  EXPECT_NE(failure(sphere, of_cap).find("1 boundary loops"), std::string::npos);
  PolygonSoup two = ball(10);
  testing::add(two, ball(10, 2, Vec3(3, 0, 0)));
  EXPECT_NE(failure(unit(repaired(two)), of_sphere).find("components"), std::string::npos);
  // Nodes of a boundary out of their order.
  LayoutOutline twisted;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}) twisted.nodes.push_back(p);
  twisted.quads = {{0, 1, 2, 3}};
  EXPECT_NE(failure(repaired(grid(1, 1)), twisted).find("follows node"), std::string::npos);
  // All nodes in one place: there is a layout, however bent, or a reason.
  LayoutOutline heap = of_sphere;
  for (Vec3& p : heap.nodes) p = heap.nodes[0];
  const TransferredLayout t = transferred(sphere, heap);
  if (t.failure.empty()) {
    expect_sound(sphere, t.layout);
    expect_quads(t.layout, heap);
  } else {
    EXPECT_TRUE(t.layout.faces.empty());
  }
}

TEST(LayoutTransfer, OutlinesThatAreNoSurfaceAreRefused) {
  const TriangleSurface sphere = unit(repaired(ball(6)));
  const LayoutOutline good = outline_of(base_of(sphere, 20), true);
  const auto refused = [&](const LayoutOutline& outline) {
    try {
      transferred(sphere, outline);
      return false;
    } catch (const Error& e) {
      return e.code() == ErrorCode::InvalidInput;
    }
  };
  EXPECT_FALSE(refused(good));
  EXPECT_TRUE(refused({}));
  LayoutOutline bad = good;
  bad.quads[0][0] = static_cast<int>(bad.nodes.size());
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.nodes[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.nodes.push_back(Vec3::Zero());  // in no quad
  EXPECT_TRUE(refused(bad));
  bad = good;
  std::swap(bad.neighbours[0][0], bad.neighbours[0][1]);
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.neighbours.pop_back();
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.sides.pop_back();
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.neighbours.clear();
  bad.quads.push_back(bad.quads[0]);
  EXPECT_TRUE(refused(bad));
}

}  // namespace
}  // namespace hybrid_mesh
