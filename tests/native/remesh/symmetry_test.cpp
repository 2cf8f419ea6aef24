// SPDX-License-Identifier: GPL-3.0-or-later
// Remeshes that are their own mirror images.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "remesh/remesh.h"
#include "sharp_shapes.h"
#include "soundness.h"
#include "symmetric_shapes.h"

namespace hybrid_mesh {
namespace {

using testing::bumpy_ball;

RemeshOptions across_x(std::int64_t vertices) {
  RemeshOptions options;
  options.vertices = vertices;
  options.symmetry = Symmetry::Given;
  options.mirror = {Vec3::UnitX(), 0};
  return options;
}

RemeshResult run(const PolygonSoup& soup, const RemeshOptions& options) {
  Context context;
  RemeshResult r = remesh(soup, options, context);
  EXPECT_EQ(context.progress(), 1);
  return r;
}

// All points have their mirror images exactly, each once, all faces theirs, and no edge in the plane is one of the boundary.
void expect_exactly_symmetric(const QuadMesh& mesh) {
  using Point = std::tuple<double, double, double>;
  std::map<Point, int> at;
  const auto key = [](const Vec3& p, double sign) { return Point(sign * p.x() + 0.0, p.y(), p.z()); };
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    ASSERT_TRUE(at.insert({key(mesh.points[v], 1), static_cast<int>(v)}).second) << "two vertices at one place";
  std::vector<int> image;
  for (const Vec3& p : mesh.points) {
    const auto found = at.find(key(p, -1));
    ASSERT_NE(found, at.end()) << p.transpose();
    image.push_back(found->second);
  }
  std::set<std::set<int>> faces, images;
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    std::set<int> face, mirrored;
    const std::int64_t begin = mesh.offsets[f], end = mesh.offsets[f + 1];
    for (std::int64_t i = begin; i < end; ++i) {
      face.insert(mesh.indices[i]);
      mirrored.insert(image[mesh.indices[i]]);
      ++edges[std::minmax(mesh.indices[i], mesh.indices[i + 1 < end ? i + 1 : begin])];
    }
    faces.insert(face);
    images.insert(mirrored);
  }
  EXPECT_EQ(faces, images);
  for (const auto& [edge, count] : edges)
    if (mesh.points[edge.first].x() == 0 && mesh.points[edge.second].x() == 0) {
      EXPECT_EQ(count, 2);
    }
}

void expect_symmetric(const RemeshResult& r) {
  EXPECT_TRUE(find_defects(r.hierarchy).empty());
  testing::expect_maps_without_defects(r.hierarchy);
  expect_exactly_symmetric(r.final_mesh);
  for (int j = 0; j <= r.hierarchy.depth(); ++j) expect_exactly_symmetric(r.hierarchy.level_mesh(j));
  for (int n = 0; n < r.hierarchy.node_count(); ++n)
    if (const PatchMap* map = r.hierarchy.map(n))
      for (const int f : map->source_face) ASSERT_LT(f, static_cast<int>(r.repaired.faces.size()));
}

class SymmetricKinds : public ::testing::TestWithParam<Refinement> {};
INSTANTIATE_TEST_SUITE_P(Refinements, SymmetricKinds, ::testing::Values(Refinement::Uniform, Refinement::Adaptive));

TEST_P(SymmetricKinds, AreExactlySymmetricWithTheTopologyAndTheBudget) {
  RemeshOptions options = across_x(2000);
  options.refinement = GetParam();
  for (const PolygonSoup& soup : {bumpy_ball(20, 0), bumpy_ball(20, 0, 0.5), testing::torus(60, 30, 0.4, 0)}) {
    const RemeshResult r = run(soup, options);
    testing::expect_sound(r);
    expect_symmetric(r);
    EXPECT_LE(r.final_mesh.points.size(), 2000U);
    EXPECT_GE(r.final_mesh.points.size(), 1900U);
    EXPECT_LT(r.report["final"]["l2"].get<double>(), 2e-3);
    EXPECT_EQ(r.report["symmetry"]["from"], "x");
    EXPECT_EQ(r.report["symmetry"]["plane"], nlohmann::ordered_json({1.0, 0.0, 0.0, 0.0}));
  }
}

TEST(Symmetry, OfEachSideAndOfTheirAverage) {
  const PolygonSoup soup = bumpy_ball(24, 0.12);
  // How far the meshes go out where the bump is on one side.
  const auto height = [&](SymmetrySide side) {
    RemeshOptions options = across_x(1500);
    options.symmetry_side = side;
    const RemeshResult r = run(soup, options);
    expect_symmetric(r);
    EXPECT_GT(r.report["symmetry"]["largest_asymmetry"].get<double>(), 0.02);
    double most = 0;
    for (const Vec3& p : r.final_mesh.points)
      if (p.normalized().dot(Vec3(-0.8, 0.5, 0.33).normalized()) > 0.985) most = std::max(most, p.norm());
    return most;
  };
  const double without = height(SymmetrySide::Positive), with = height(SymmetrySide::Negative), mean = height(SymmetrySide::Average);
  EXPECT_GT(with - without, 0.07);
  EXPECT_NEAR(mean, 0.5 * (with + without), 0.02);
}

TEST(Symmetry, OfSidesThatDifferTooMuchHasNoAverage) {
  RemeshOptions options = across_x(1500);
  options.symmetry_side = SymmetrySide::Average;
  EXPECT_THROW(run(bumpy_ball(16, 0.9), options), Error);
}

TEST(Symmetry, KeepsSharpEdges) {
  // A box with the plane through its middle: twelve edges, four of which are cut.
  const PolygonSoup box = shapes::prism({{-2, -1}, {2, -1}, {2, 1}, {-2, 1}}, 1.2);
  const RemeshResult r = run(box, across_x(2000));
  testing::expect_sound(r);
  expect_symmetric(r);
  EXPECT_TRUE(r.report["features"]["kept"].get<bool>());
  double length = 0;
  const QuadMesh& mesh = r.final_mesh;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
      if (mesh.sharp[i])
        length += 0.5 * (mesh.points[mesh.indices[i]] - mesh.points[mesh.indices[i + 1 < mesh.offsets[f + 1] ? i + 1 : mesh.offsets[f]]]).norm();
  EXPECT_NEAR(length, 4 * (4 + 2 + 1.2), 1e-9);
}

TEST(Symmetry, InThePlaneOfASharpEdgeKeepsIt) {
  // A roof: its ridge is in the plane.
  const PolygonSoup roof = shapes::prism({{-1, 0}, {1, 0}, {0, 1}}, 3);
  const RemeshResult r = run(roof, across_x(2000));
  expect_symmetric(r);
  const QuadMesh& mesh = r.final_mesh;
  double ridge = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i) {
      const Vec3 &a = mesh.points[mesh.indices[i]], &b = mesh.points[mesh.indices[i + 1 < mesh.offsets[f + 1] ? i + 1 : mesh.offsets[f]]];
      if (mesh.sharp[i] && a.x() == 0 && b.x() == 0 && a.y() > 0.9 && b.y() > 0.9) ridge += 0.5 * (a - b).norm();
    }
  EXPECT_NEAR(ridge, 3, 1e-9);
}

TEST(Symmetry, IsFoundOrDoneWithout) {
  RemeshOptions options;
  options.vertices = 1000;
  options.symmetry = Symmetry::Auto;
  const RemeshResult found = run(bumpy_ball(20, 0), options);
  expect_symmetric(found);
  EXPECT_EQ(found.report["symmetry"]["from"], "auto");
  const PolygonSoup lopsided = testing::lopsided_ball(20);
  const RemeshResult without = run(lopsided, options);
  testing::expect_sound(without);
  EXPECT_TRUE(without.report["symmetry"]["plane"].is_null());
  EXPECT_FALSE(without.report["symmetry"]["reason"].get<std::string>().empty());
  options.symmetry = Symmetry::None;
  const RemeshResult plain = run(lopsided, options);
  EXPECT_FALSE(plain.report.contains("symmetry"));
  EXPECT_EQ(plain.final_mesh.points, without.final_mesh.points);
}

TEST(Symmetry, OfAMinimalBaseAndWithAnErrorBound) {
  RemeshOptions minimal = across_x(1500), bound = across_x(0);
  minimal.base = BaseSize::Minimal;
  bound.error = 2e-3;
  for (const RemeshOptions& options : {minimal, bound}) {
    const RemeshResult r = run(bumpy_ball(20, 0), options);
    testing::expect_sound(r);
    expect_symmetric(r);
    EXPECT_LT(r.report["final"]["l2"].get<double>(), 2.5e-3);
  }
}

TEST(Symmetry, OfPairsThatThePlaneDoesNotTouch) {
  PolygonSoup two = testing::ball(10, 2, Vec3(3, 0, 0));
  testing::add(two, testing::ball(10, 2, Vec3(-3, 0, 0)));
  const RemeshResult r = run(two, across_x(1000));
  testing::expect_sound(r);
  expect_symmetric(r);
}

TEST(Symmetry, RefusesWhatDoesNotGoTogetherWithIt) {
  const PolygonSoup soup = bumpy_ball(10, 0);
  const auto message = [&](const RemeshOptions& options) {
    try {
      run(soup, options);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::InvalidInput);
      return std::string(e.what());
    }
    return std::string();
  };
  RemeshOptions late = across_x(500), joined = late, planned = late, beside = late, skewed = late;
  late.topology = TopologyMode::Late;
  joined.components = Components::Joined;
  planned.plan = run(soup, across_x(500)).plan;
  beside.mirror.offset = 7;
  skewed.mirror.normal = Vec3(1, 1, 0);
  EXPECT_NE(message(late).find("late topology"), std::string::npos);
  EXPECT_NE(message(joined).find("joined components"), std::string::npos);
  EXPECT_NE(message(planned).find("plan"), std::string::npos);
  EXPECT_NE(message(beside).find("wholly on one side of the plane of symmetry (x = 7)"), std::string::npos);
  EXPECT_NE(message(skewed).find("normal"), std::string::npos);
}

}  // namespace
}  // namespace hybrid_mesh
