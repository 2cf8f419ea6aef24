// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/base/curve_classes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "generated_surfaces.h"
#include "layout/base/base_domain.h"
#include "layouts.h"
#include "sharp_shapes.h"

namespace hybrid_mesh {
namespace {

using testing::repaired;
using testing::unit;

// Pieces of which any two are connected by curves that can change have even rims in the end, whatever the classes and the numbers.
TEST(CurveClasses, MakeEveryRimEvenThatIsConnectedWithTheOthers) {
  std::mt19937 random(5);
  const auto below = [&](std::size_t n) { return static_cast<int>(random() % n); };
  for (int round = 0; round < 300; ++round) {
    CurveClasses classes;
    classes.rims.resize(2 + below(30));
    std::vector<int> wanted, least;
    const auto add_curve = [&](int a, int b, int room) {
      const int c = static_cast<int>(classes.edges.size());
      classes.rims[a].push_back(c), classes.rims[b].push_back(c);
      least.push_back(1 + below(3));
      classes.edges.push_back(least.back() + room);
      wanted.push_back(least.back() + below(room + 1));
    };
    for (int p = 1; p < static_cast<int>(classes.rims.size()); ++p) add_curve(p, below(p), 1 + below(3));  // a tree
    for (int k = below(20); k > 0; --k) add_curve(below(classes.rims.size()), below(classes.rims.size()), 0);
    for (int c = 0; c < static_cast<int>(classes.edges.size()); ++c) {
      if (classes.curves.empty() || below(2) == 0) classes.curves.emplace_back();
      classes.curves.back().push_back(c);
    }
    classes.make_even(wanted, least);
    for (const std::vector<int>& rim : classes.rims) {
      const int edges = std::accumulate(rim.begin(), rim.end(), 0, [&](int sum, int c) { return sum + wanted[c]; });
      ASSERT_EQ(edges % 2, 0);
    }
    for (std::size_t c = 0; c < wanted.size(); ++c) {
      ASSERT_GE(wanted[c], least[c]);
      ASSERT_LE(wanted[c], classes.edges[c]);
    }
  }
}

// The ends of a long rod whose section is a lens have two sides each, which are short for a quad. Neither can be left with one edge where the other
// is.
TEST(CurveClasses, AFaceOfTwoShortSidesKeepsRoomForAQuad) {
  std::vector<Vec2> lens;
  const int n = 12;
  for (const double side : {-1.0, 1.0})
    for (int i = 0; i < n; ++i) {
      const double angle = std::numbers::pi / 3 * (2.0 * i / n - 1);  // of an arc around (0, -side / 2)
      lens.push_back({-side * std::sin(angle), side * (std::cos(angle) - 0.5)});
    }
  const TriangleSurface rod = repaired(shapes::prism(lens, 40));
  Context context;
  const WorkingSurface working = make_working_surface(rod, placement_of(rod.points), 4000, Progress(context), {}, FeatureOptions());
  ASSERT_FALSE(working.features.empty());
  BaseDomainOptions options;
  options.size = 60;
  BaseDomain base(working.mesh, working.features, options, Progress(context));
  EXPECT_TRUE(base.has_features());
  testing::expect_layout(working.mesh, base.cut(testing::whole_surface, Progress(context)).patches);
}

}  // namespace
}  // namespace hybrid_mesh
