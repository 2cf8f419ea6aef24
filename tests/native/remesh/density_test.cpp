// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/density.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "codec/container.h"
#include "generated_surfaces.h"
#include "remesh/remesh.h"
#include "soundness.h"

namespace hybrid_mesh {
namespace {

using testing::ball;
using testing::repaired;

template <class Value>
PolygonSoup painted(PolygonSoup soup, const Value& value) {
  for (const Vec3& p : soup.points) soup.density.push_back(value(p));
  return soup;
}

// Sizes differ fourfold from one end to the other.
double gradient(const Vec3& p) { return 0.5 + 0.25 * std::clamp(p.z(), -1.0, 1.0); }

RemeshOptions options_of(std::int64_t vertices, Refinement refinement = Refinement::Uniform) {
  RemeshOptions options;
  options.vertices = vertices;
  options.refinement = refinement;
  options.density = "paint";
  return options;
}

RemeshResult run(const PolygonSoup& soup, const RemeshOptions& options) {
  Context context;
  return remesh(soup, options, context);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// As the report's `met`, of the edges themselves and by a formula of the sizes.
template <class Value>
double median_error(const QuadMesh& mesh, const Value& value) {
  std::vector<double> errors;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) {
      const Vec3 &a = mesh.points[mesh.indices[i]], &b = mesh.points[mesh.indices[i + 1 < mesh.offsets[f + 1] ? i + 1 : mesh.offsets[f]]];
      errors.push_back(std::log((b - a).norm() / size_at_density(value(0.5 * (a + b)))));
    }
  const double factor = median(errors);
  for (double& e : errors) e = std::abs(e - factor);
  return median(std::move(errors));
}

std::string refusal(const PolygonSoup& soup) {
  try {
    run(soup, options_of(500));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
    return error.what();
  }
  return {};
}

TEST(SizeField, KeepsTheAreaAndGoesByItsPoints) {
  TriangleSurface surface = repaired(ball(12));
  std::vector<double> size;
  for (const Vec3& p : surface.points) size.push_back(7 * size_at_density(gradient(p)));
  surface.sizes = std::make_shared<const SizeField>(surface, size);
  EXPECT_NEAR(measured_area(surface), surface_area(surface), 1e-9 * surface_area(surface));
  const std::vector<double> fineness = fineness_at_points(surface);
  for (std::size_t v = 1; v < size.size(); ++v) EXPECT_NEAR(fineness[v] * size[v], fineness[0] * size[0], 1e-9 * fineness[0] * size[0]);
  surface.sizes = std::make_shared<const SizeField>(surface, std::vector<double>(size.size(), 3.0));
  for (const double f : fineness_at_points(surface)) EXPECT_NEAR(f, 1, 1e-12);
}

TEST(SizeField, GradedSizesGrowNoFasterThanTheirSlopeAndAreTheLargestThatDoNot) {
  const TriangleSurface surface = repaired(ball(16));
  std::vector<double> size;
  for (const Vec3& p : surface.points) size.push_back(p.z() > 0.3 ? 0.25 : 4.0);
  constexpr double slope = 1.5;
  const std::vector<double> made = graded(surface, size, slope);
  std::vector<double> most = size;  // that a neighbour allows
  for (int h = 0; h < static_cast<int>(surface.opposite.size()); ++h) {
    const int a = surface.from(h), b = surface.to(h);
    const double length = (surface.points[b] - surface.points[a]).norm();
    EXPECT_LE(made[b], made[a] + slope * length + 1e-12);
    most[b] = std::min(most[b], made[a] + slope * length);
  }
  for (std::size_t v = 0; v < size.size(); ++v) EXPECT_NEAR(made[v], most[v], 1e-12);
  EXPECT_EQ(graded(surface, made, slope), made);
}

TEST(Density, IsAFactorOfFourEitherWay) {
  EXPECT_DOUBLE_EQ(size_at_density(0.5), 1);
  EXPECT_DOUBLE_EQ(size_at_density(1), 0.25);
  EXPECT_DOUBLE_EQ(size_at_density(0), 4);
  EXPECT_DOUBLE_EQ(size_at_density(-3), 4);
  EXPECT_DOUBLE_EQ(size_at_density(7), 0.25);
}

TEST(Density, ComesThroughRepair) {
  // Points repeat along the octahedron's edges: where they say different things, their mean counts.
  PolygonSoup soup = painted(ball(10), gradient);
  const TriangleSurface surface = repaired(soup);
  ASSERT_LT(surface.points.size(), soup.points.size());
  const Density same = read_density(soup, "paint", surface, Placement());
  for (std::size_t v = 0; v < surface.points.size(); ++v) EXPECT_NEAR(same.values[v], gradient(surface.points[v]), 1e-12);
  std::map<std::array<double, 3>, std::vector<double>> at;
  for (std::size_t v = 0; v < soup.points.size(); ++v) {
    soup.density[v] = static_cast<double>(v % 7) / 6;
    at[{soup.points[v].x(), soup.points[v].y(), soup.points[v].z()}].push_back(soup.density[v]);
  }
  const Density mean = read_density(soup, "paint", surface, Placement());
  for (std::size_t v = 0; v < surface.points.size(); ++v) {
    const Vec3& p = surface.points[v];
    double sum = 0;
    for (const double value : at.at({p.x(), p.y(), p.z()})) sum += value;
    EXPECT_NEAR(mean.values[v], sum / static_cast<double>(at.at({p.x(), p.y(), p.z()}).size()), 1e-12);
  }
}

TEST(Density, QuadsOfAUniformMeshHaveTheSizes) {
  const PolygonSoup soup = painted(ball(30), gradient);
  for (const std::int64_t vertices : {2000, 6000}) {
    const RemeshResult r = run(soup, options_of(vertices));
    testing::expect_sound(r);
    testing::expect_maps_without_defects(r.hierarchy);
    EXPECT_GE(static_cast<double>(r.final_mesh.points.size()), 0.98 * static_cast<double>(vertices));
    EXPECT_LE(static_cast<std::int64_t>(r.final_mesh.points.size()), vertices);
    EXPECT_LE(median_error(r.final_mesh, gradient), std::log(1.25));
    const auto& density = r.report["density"];
    EXPECT_EQ(density["name"], "paint");
    EXPECT_LE(density["met"].get<double>(), std::log(1.25));
    EXPECT_NEAR(density["largest"].get<double>() / density["smallest"].get<double>(), 4, 0.5);
    EXPECT_LE(r.report["final"]["scaled_jacobian"]["inverted"].get<double>(), 0.001);
  }
  // Without it they are even, and so far from what is wanted.
  RemeshOptions even = options_of(2000);
  even.density.clear();
  PolygonSoup plain = soup;
  plain.density.clear();
  const RemeshResult r = run(plain, even);
  EXPECT_GT(median_error(r.final_mesh, gradient), std::log(1.25));
  EXPECT_FALSE(r.report.contains("density"));
}

TEST(Density, SplitsLeavesOfAnAdaptiveMeshWhereItIsHigh) {
  const PolygonSoup soup = painted(ball(30), gradient);
  RemeshOptions even = options_of(3000, Refinement::Adaptive);
  even.density.clear();
  PolygonSoup plain = soup;
  plain.density.clear();
  const auto share_above = [](const RemeshResult& r) {
    testing::expect_sound(r);
    const auto& points = r.final_mesh.points;
    return static_cast<double>(std::count_if(points.begin(), points.end(), [](const Vec3& p) { return p.z() > 0; })) /
           static_cast<double>(points.size());
  };
  const double with = share_above(run(soup, options_of(3000, Refinement::Adaptive))), without = share_above(run(plain, even));
  EXPECT_GT(with, without + 0.15);
}

TEST(Density, OfOneValueChangesNothing) {
  const PolygonSoup plain = ball(14);
  RemeshOptions even = options_of(1500);
  even.density.clear();
  const auto bytes = encode_hierarchy(run(plain, even).hierarchy, "{}");
  for (const double value : {0.2, 0.5, 1.0})
    EXPECT_EQ(encode_hierarchy(run(painted(plain, [&](const Vec3&) { return value; }), options_of(1500)).hierarchy, "{}"), bytes);
}

TEST(Density, IsPartOfWhatAPlanWasMadeOf) {
  const PolygonSoup soup = painted(ball(20), gradient);
  const RemeshResult first = run(soup, options_of(2000));
  RemeshOptions planned = options_of(2000);
  planned.plan = first.plan;
  EXPECT_EQ(encode_hierarchy(run(soup, planned).hierarchy, "{}"), encode_hierarchy(first.hierarchy, "{}"));
}

TEST(Density, ThatCannotBeReadIsRefusedByName) {
  PolygonSoup soup = painted(ball(8), gradient);
  soup.density.pop_back();
  EXPECT_NE(refusal(soup).find("the density 'paint' has " + std::to_string(soup.density.size()) + " values"), std::string::npos);
  soup.density.clear();
  EXPECT_NE(refusal(soup).find("the density 'paint' has 0 values"), std::string::npos);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    soup = painted(ball(8), gradient);
    soup.density[5] = bad;
    EXPECT_NE(refusal(soup).find("the density 'paint' is not a finite number at point 5"), std::string::npos);
  }
}

}  // namespace
}  // namespace hybrid_mesh
