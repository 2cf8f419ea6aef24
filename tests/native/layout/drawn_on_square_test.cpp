// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <set>

#include "drawn_checks.h"
#include "drawn_strokes.h"
#include "layout/drawn/drawn_layout.h"
#include "layout_checks.h"
#include "parameterization/convex_map.h"

namespace hybrid_mesh {
namespace {

using testing::all_messages;
using testing::count;
using testing::expect_maps;
using testing::expect_origins;
using testing::expect_sound;
using testing::face_sizes;
using testing::layout_of;
using testing::repaired;
using Kind = LayoutProblem::Kind;

// The unit square, and lines on it.
class DrawnOnASquare : public ::testing::TestWithParam<int> {
 protected:
  DrawnOnASquare() : surface_(square(GetParam())) {}
  static TriangleSurface square(int n) {
    TriangleSurface s = repaired(grid(n, n));
    for (Vec3& p : s.points) p /= n;
    return s;
  }
  DrawnStroke line(const Vec2& a, const Vec2& b, double height = 0.005) const {
    DrawnStroke s;
    for (int i = 0; i <= 10; ++i) {
      const Vec2 p = a + i / 10.0 * (b - a);
      s.points.push_back(Vec3(p.x(), p.y(), height * (i % 2)));
    }
    return s;
  }
  DrawnLayout drawn(const std::vector<DrawnStroke>& strokes, const DrawnLayoutOptions& options = {}) {
    DrawnLayout d = layout_of(surface_, strokes, options);
    expect_sound(surface_, d.layout);
    expect_origins(d, static_cast<int>(strokes.size()));
    return d;
  }
  TriangleSurface surface_;
};

INSTANTIATE_TEST_SUITE_P(Resolutions, DrawnOnASquare, ::testing::Values(1, 2, 7, 40));

TEST_P(DrawnOnASquare, WithoutStrokesItIsOneQuad) {
  const DrawnLayout d = drawn({});
  EXPECT_EQ(all_messages(d), "");
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4}));
  expect_maps(surface_, d.layout);
}

TEST_P(DrawnOnASquare, FromBoundaryToBoundary) {
  // One ends early, one goes on beyond the surface.
  const DrawnLayout d = drawn({line({0.5, 0.015}, {0.48, 1.03})});
  EXPECT_EQ(all_messages(d), "");
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4}));
  for (const PatchLayout::Curve& c : d.layout.curves) {
    if (c.boundary) continue;
    EXPECT_NEAR(d.layout.mesh.points[c.points.front()].y() + d.layout.mesh.points[c.points.back()].y(), 1, 1e-12);
  }
  expect_maps(surface_, d.layout);
}

TEST_P(DrawnOnASquare, AStrokeThatCrossesTwoOthers) {
  const DrawnLayout d = drawn({line({-0.01, 0.3}, {1.01, 0.32}), line({0, 0.7}, {1, 0.69}), line({0.6, 0}, {0.55, 1})});
  EXPECT_EQ(all_messages(d), "");
  EXPECT_EQ(d.layout.nodes.size(), 12u);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 4, 4, 4, 4}));
  expect_maps(surface_, d.layout);
}

TEST_P(DrawnOnASquare, OvershootsAndGapsAtACurve) {
  for (const double end : {0.48, 0.495, 0.5, 0.505, 0.52}) {
    const DrawnLayout d = drawn({line({0, 0.5}, {1, 0.5}), line({0.4, 0}, {0.4, end})});
    // A T: the face above has five sides.
    EXPECT_EQ(d.layout.nodes.size(), 4u + 2 + 2) << end;
    EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 5})) << end;
    EXPECT_EQ(count(d, Kind::OddSides), 1);
    EXPECT_EQ(d.problems.size(), 1u) << all_messages(d);
  }
  // Farther beyond it dangles.
  EXPECT_EQ(count(drawn({line({0, 0.5}, {1, 0.5}), line({0.4, 0}, {0.4, 0.6})}), Kind::Dangling), 1);
  EXPECT_EQ(count(drawn({line({0, 0.5}, {1, 0.5}), line({0.4, 0}, {0.4, 0.4})}), Kind::Dangling), 1);
}

TEST_P(DrawnOnASquare, TwoStrokesThatMeetEndToEndMakeANode) {
  const DrawnLayout d = drawn({line({0, 0.5}, {0.495, 0.5}), line({0.505, 0.505}, {1, 0.5})});
  EXPECT_EQ(d.layout.nodes.size(), 7u);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{5, 5}));
}

TEST_P(DrawnOnASquare, FiveAndSixSides) {
  const std::vector<DrawnStroke> one{line({0.5, 0}, {0.5, 1}), line({0, 0.5}, {0.5, 0.5})};
  DrawnLayout d = drawn(one);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 5}));
  ASSERT_EQ(d.problems.size(), 1u) << all_messages(d);
  EXPECT_EQ(d.problems[0].kind, Kind::OddSides);
  EXPECT_NE(d.problems[0].message.find("5 sides"), std::string::npos);
  EXPECT_THROW(to_patched_surface(d.layout), Error);

  d = drawn({line({0.5, 0}, {0.5, 1}), line({0, 0.3}, {0.5, 0.3}), line({0, 0.7}, {0.5, 0.7})});
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 4, 6}));
  EXPECT_EQ(all_messages(d), "");
  EXPECT_FALSE(d.layout.is_quads());
  // Cut out, the face of six sides is a disk, which can be mapped to a hexagon.
  for (int f = 0; f < 4; ++f) {
    const LayoutFacePart part = cut_out(d.layout, f);
    const int sides = static_cast<int>(part.sides.size());
    EXPECT_EQ(sides, d.layout.faces[f].side_count());
    std::set<int> rim;
    for (int i = 0; i < sides; ++i) {
      EXPECT_EQ(part.sides[i].back(), part.sides[(i + 1) % sides].front());
      rim.insert(part.sides[i].begin(), part.sides[i].end());
    }
    for (int h = 0; h < static_cast<int>(part.mesh.opposite.size()); ++h)
      if (part.mesh.opposite[h] < 0) {
        EXPECT_TRUE(rim.count(part.mesh.from(h)));
      }
    TriangleSurface mesh = part.mesh;
    std::vector<PointSource> source(mesh.points.size());
    std::vector<DiskSide> disk;
    std::vector<Vec2> polygon;
    for (int i = 0; i < sides; ++i) {
      disk.push_back({part.sides[i], {}});
      polygon.push_back(Vec2(std::cos(2 * std::numbers::pi * i / sides), std::sin(2 * std::numbers::pi * i / sides)));
    }
    ConvexMap map(mesh);
    std::vector<int> faces;
    for (;;) {
      faces.resize(mesh.faces.size());
      for (std::size_t k = 0; k < faces.size(); ++k) faces[k] = static_cast<int>(k);
      const std::vector<int> chords = map.side_chords(faces, disk);
      if (chords.empty()) break;
      for (const int h : chords) split_inner_edge(mesh, source, h);
      connect_half_edges(mesh);
    }
    std::vector<std::array<Vec2, 3>> corners(mesh.faces.size());
    EXPECT_TRUE(map(faces, disk, polygon, corners));
  }
}

TEST_P(DrawnOnASquare, AClosedStrokeMakesARing) {
  DrawnStroke circle;
  for (int i = 0; i <= 30; ++i) circle.points.push_back(Vec3(0.5 + 0.2 * std::cos(0.205 * i), 0.5 + 0.2 * std::sin(0.205 * i), 0.01));
  DrawnLayout d = drawn({circle});
  EXPECT_EQ(count(d, Kind::NotADisk), 1);
  EXPECT_EQ(count(d, Kind::TooFewSides), 1);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{1, 5}));
  EXPECT_NE(all_messages(d).find("ring"), std::string::npos);
  // Joined with the corners, it is the classic of five quads. Where it began is no node.
  std::vector<DrawnStroke> strokes{circle};
  for (const double x : {0.0, 1.0})
    for (const double y : {0.0, 1.0}) strokes.push_back(line({x, y}, {0.5 + 0.1414 * (2 * x - 1), 0.5 + 0.1414 * (2 * y - 1)}));
  d = drawn(strokes);
  EXPECT_EQ(all_messages(d), "");
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 4, 4, 4}));
  if (d.layout.is_quads()) expect_maps(surface_, d.layout);
}

TEST_P(DrawnOnASquare, StrokesThatCannotBeUsedAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  DrawnStroke far = line({0, 0.5}, {1, 0.5}), broken = far, endless = far, near = line({0.5, 0}, {0.5, 1});
  for (Vec3& p : far.points) p.z() = 2;
  broken.points[4].x() = nan;
  endless.points[4].z() = infinity;
  DrawnStroke huge = far;
  huge.points[3].y() = 1e300;
  const std::vector<DrawnStroke> strokes{
      far, broken, endless, huge, {}, {{Vec3(0.5, 0.5, 0)}}, {{Vec3(0.5, 0.5, 0), Vec3(0.5, 0.5, 0)}}, {{Vec3(0.5, 0.5, 0), Vec3(0.505, 0.5, 0)}},
      near};
  const DrawnLayout d = drawn(strokes);
  ASSERT_EQ(d.problems.size(), 8u) << all_messages(d);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(d.problems[i].stroke, i);
    EXPECT_EQ(d.problems[i].kind, i == 0 || i == 3 ? Kind::OffSurface : Kind::Unusable);
    for (const Vec3& p : d.problems[i].where) EXPECT_TRUE(std::isfinite(p.x()));
  }
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4}));
}

TEST_P(DrawnOnASquare, AStrokeToAndFroOverTheBoundaryIsNotHundredsOfCurves) {
  DrawnStroke scribble;
  for (int i = 0; i <= 600; ++i) scribble.points.push_back(Vec3(0.1 + 0.8 * i / 600, i % 2 ? 0.1 : -0.1, 0));
  DrawnLayoutOptions options;
  options.reach = 0.2;
  const DrawnLayout d = drawn({scribble, line({0.5, 0}, {0.5, 1})}, options);
  ASSERT_EQ(d.problems.size(), 1u);
  EXPECT_EQ(d.problems[0].kind, Kind::Unusable);
  EXPECT_EQ(d.problems[0].stroke, 0);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4}));
}

TEST_P(DrawnOnASquare, StrokesDrawnTwiceAreNamed) {
  const DrawnStroke a = line({0, 0.5}, {1, 0.5});
  DrawnStroke shifted = a, back = a;
  for (Vec3& p : shifted.points) p.y() += 0.003;
  std::reverse(back.points.begin(), back.points.end());
  back.points.insert(back.points.begin(), a.points.begin(), a.points.end());
  for (const std::vector<DrawnStroke>& strokes : {std::vector<DrawnStroke>{a, a}, {a, shifted}, {a, back}, {a, a, a}}) {
    const DrawnLayout d = drawn(strokes);
    EXPECT_EQ(count(d, Kind::Overlap), static_cast<int>(strokes.size()) - 1) << all_messages(d);
    EXPECT_EQ(d.problems.size(), strokes.size() - 1);
    EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4}));
  }
  // Along the boundary.
  const DrawnLayout d = drawn({line({0.1, -0.005}, {0.9, -0.005})});
  EXPECT_EQ(count(d, Kind::Overlap), 1);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4}));
}

TEST_P(DrawnOnASquare, TightOrAsDrawn) {
  DrawnStroke arch;
  for (int i = 0; i <= 40; ++i) arch.points.push_back(Vec3(i / 40.0, 0.5 + 0.2 * std::sin(std::numbers::pi * i / 40), 0));
  arch.points[0].x() += 0.001;
  const auto curve_of = [](const DrawnLayout& d, int stroke) {
    for (const PatchLayout::Curve& c : d.layout.curves)
      if (c.stroke == stroke) {
        std::vector<Vec3> line;
        for (const int v : c.points) line.push_back(d.layout.mesh.points[v]);
        return line;
      }
    return std::vector<Vec3>();
  };
  for (const Vec3& p : curve_of(drawn({arch}), 0)) EXPECT_NEAR(p.y(), 0.5, 0.002);
  arch.fit = DrawnStroke::Fit::AsDrawn;
  for (const Vec3& p : curve_of(drawn({arch}), 0)) EXPECT_NEAR(p.y(), 0.5 + 0.2 * std::sin(std::numbers::pi * p.x()), 0.02);
  // One that would cut the arch if it were straight is led along it, without a crossing.
  DrawnStroke above = arch;
  above.fit = DrawnStroke::Fit::Tight;
  for (Vec3& p : above.points) p.y() += 0.06;
  const DrawnLayout d = drawn({arch, above});
  EXPECT_EQ(all_messages(d), "");
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{4, 4, 4}));
  double length = 0;
  const std::vector<Vec3> line = curve_of(d, 1);
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  EXPECT_LT(length, 1.075);  // hugs the top of the arch
  EXPECT_GT(length, 1.02);
}

TEST_P(DrawnOnASquare, AGivenBoundaryHasNoOtherNodes) {
  DrawnLayoutOptions options;
  int middle = -1;
  for (int v = 0; v < static_cast<int>(surface_.points.size()); ++v) {
    const Vec3 p = surface_.points[v];
    if ((p.x() == 0 || p.x() == 1) && (p.y() == 0 || p.y() == 1)) options.boundary_nodes.push_back(v);
    if (p.x() > 0 && p.x() < 1 && p.y() == 0) middle = v;
  }
  const DrawnLayout none = drawn({}, options);
  EXPECT_EQ(all_messages(none), "");
  // The nodes are numbered as they are given.
  for (std::size_t i = 0; i < options.boundary_nodes.size(); ++i) EXPECT_EQ(none.layout.nodes[i], options.boundary_nodes[i]);
  // From node to node: the boundary itself is as it was.
  const DrawnLayout diagonal = drawn({line({0.01, 0.01}, {0.98, 1})}, options);
  EXPECT_EQ(face_sizes(diagonal.layout), (std::multiset<int>{3, 3}));
  const auto boundary = [](const TriangleSurface& s) {
    std::set<std::pair<double, double>> points;
    for (int h = 0; h < static_cast<int>(s.opposite.size()); ++h)
      if (s.opposite[h] < 0) points.insert({s.points[s.from(h)].x(), s.points[s.from(h)].y()});
    return points;
  };
  EXPECT_EQ(boundary(diagonal.layout.mesh), boundary(surface_));
  const DrawnLayout d = drawn({line({0.01, 0.01}, {0.5, 0.99})}, options);
  EXPECT_EQ(count(d, Kind::BetweenNodes), 1);
  EXPECT_EQ(face_sizes(d.layout), (std::multiset<int>{3, 4}));
  if (middle >= 0) {
    options.boundary_nodes = {middle};
    EXPECT_EQ(face_sizes(drawn({}, options).layout), (std::multiset<int>{1}));
  }
  options.boundary_nodes = {static_cast<int>(surface_.points.size())};
  EXPECT_THROW(layout_of(surface_, {}, options), Error);
}

TEST_P(DrawnOnASquare, TheSameWhereverItStandsAndHoweverLargeItIs) {
  const std::vector<DrawnStroke> strokes{line({-0.01, 0.3}, {1.01, 0.32}), line({0.4, 0.31}, {0.4, 1})};
  const DrawnLayout here = drawn(strokes);
  for (const double scale : {1e-9, 1e-3, 1e6}) {
    TriangleSurface surface = surface_;
    std::vector<DrawnStroke> moved = strokes;
    const Vec3 by = scale * Vec3(20, -40, 10);
    for (Vec3& p : surface.points) p = scale * p + by;
    for (DrawnStroke& s : moved)
      for (Vec3& p : s.points) p = scale * p + by;
    const DrawnLayout there = layout_of(surface, moved);
    EXPECT_EQ(face_sizes(there.layout), face_sizes(here.layout));
    EXPECT_EQ(all_messages(there), all_messages(here));
    EXPECT_EQ(there.layout.nodes.size(), here.layout.nodes.size());
  }
  const DrawnLayout again = drawn(strokes);
  EXPECT_EQ(again.layout.mesh.faces, here.layout.mesh.faces);
  for (std::size_t v = 0; v < again.layout.mesh.points.size(); ++v) EXPECT_EQ(again.layout.mesh.points[v], here.layout.mesh.points[v]);
}

TEST_P(DrawnOnASquare, OptionsOutOfRangeAreRefused) {
  for (const double bad : {-0.1, 0.6, std::numeric_limits<double>::quiet_NaN()}) {
    DrawnLayoutOptions options;
    options.snap = bad;
    EXPECT_THROW(layout_of(surface_, {}, options), Error);
  }
  DrawnLayoutOptions exact;
  exact.snap = 0;
  const DrawnLayout d = drawn({line({0, 0.5}, {1, 0.5}, 0)}, exact);
  EXPECT_EQ(d.layout.nodes.size(), 6u);
  Context context;
  context.cancel();
  EXPECT_THROW(make_layout(surface_, {line({0, 0.5}, {1, 0.5})}, {}, Progress(context)), Error);
}

}  // namespace
}  // namespace hybrid_mesh
