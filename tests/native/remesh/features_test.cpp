// SPDX-License-Identifier: GPL-3.0-or-later
// Sharp edges of the input, from the base to the mesh.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "codec/container.h"
#include "remesh/plans.h"
#include "remesh/soundness.h"
#include "sharp_shapes.h"

namespace hybrid_mesh {
namespace {

using testing::Json;
using testing::run;
using Edge = std::pair<Vec3, Vec3>;

double distance_to(const Edge& edge, const Vec3& p) {
  const Vec3 way = edge.second - edge.first;
  const double t = std::clamp((p - edge.first).dot(way) / way.squaredNorm(), 0.0, 1.0);
  return (edge.first + t * way - p).norm();
}

std::vector<Edge> sharp_edges(const PolygonSoup& soup) { return shapes::sharp_edges(soup.points, soup.indices, soup.offsets, 40); }

double length_of(const std::vector<Edge>& edges) {
  double sum = 0;
  for (const Edge& e : edges) sum += (e.second - e.first).norm();
  return sum;
}

// The mesh's edges that are told to be sharp, each once; expects each of them to be told from both sides.
std::vector<Edge> marked_edges(const QuadMesh& mesh) {
  std::multiset<std::pair<int, int>> seen;
  for (std::size_t f = 0; f < mesh.face_count() && !mesh.sharp.empty(); ++f)
    for (std::int64_t i = mesh.offsets[f]; i < mesh.offsets[f + 1]; ++i)
      if (mesh.sharp[i]) seen.insert(std::minmax<int>(mesh.indices[i], mesh.indices[i + 1 < mesh.offsets[f + 1] ? i + 1 : mesh.offsets[f]]));
  std::vector<Edge> edges;
  for (auto at = seen.begin(); at != seen.end(); at = seen.upper_bound(*at)) {
    EXPECT_EQ(seen.count(*at), 2u);
    edges.push_back({mesh.points[at->first], mesh.points[at->second]});
  }
  return edges;
}

// The marked edges are those of the solid, whole, and its corners are vertices.
void expect_edges_of(const PolygonSoup& solid, const QuadMesh& mesh) {
  const std::vector<Edge> wanted = sharp_edges(solid), marked = marked_edges(mesh);
  for (const Edge& e : marked) {
    double off = 1e300;
    for (const Edge& w : wanted) off = std::min(off, std::max(distance_to(w, e.first), distance_to(w, e.second)));
    ASSERT_LT(off, 1e-9);
  }
  EXPECT_NEAR(length_of(marked), length_of(wanted), 1e-9 * length_of(wanted));
  for (const Vec3& corner : solid.points) {
    double off = 1e300;
    for (const Vec3& p : mesh.points) off = std::min(off, (p - corner).norm());
    EXPECT_LT(off, 1e-12);
  }
}

RemeshOptions bounded(std::int64_t vertices) {
  RemeshOptions options;
  options.vertices = vertices;
  return options;
}

TEST(Features, SolidsComeOutExactly) {
  for (const PolygonSoup& solid : {shapes::cube(), shapes::l_prism(), shapes::frame()}) {
    const RemeshResult made = run(solid, bounded(3000));
    testing::expect_sound(made);
    EXPECT_LT(made.report["final"]["l2"].get<double>(), 1e-12);
    EXPECT_LT(made.report["final"]["hausdorff"].get<double>(), 1e-12);
    EXPECT_GT(made.report["final"]["scaled_jacobian"]["p05"].get<double>(), 0.6);
    EXPECT_EQ(made.report["features"]["kept"], true);
    EXPECT_EQ(made.report["features"]["corners"].get<std::size_t>(), solid.points.size());
    expect_edges_of(solid, made.final_mesh);
    // So does every level: its sides are straight.
    for (int level = 0; level < made.hierarchy.depth(); ++level) expect_edges_of(solid, made.hierarchy.level_mesh(level));
  }
}

TEST(Features, ASmallCubeIsAsRegularAsCubesAre) {
  const RemeshResult made = run(shapes::cube(), bounded(100));
  EXPECT_EQ(made.report["final"]["irregular_vertices"]["base"], 8);
  EXPECT_GT(made.report["final"]["scaled_jacobian"]["min"].get<double>(), 0.99);
}

TEST(Features, ManySmallSolidsHaveRoomForThemInFewVertices) {
  constexpr int count = 24;
  const RemeshResult made = run(shapes::cubes(count), bounded(27 * count));
  testing::expect_sound(made);
  EXPECT_EQ(made.report["features"]["kept"], true);
  EXPECT_EQ(made.report["features"]["corners"], 8 * count);
  EXPECT_EQ(made.final_mesh.points.size(), 26u * count);
  EXPECT_LT(made.report["final"]["hausdorff"].get<double>(), 1e-12);
  // Exact as it is, with all the vertices that four quads a face need: the few that are left count for nothing.
  EXPECT_EQ(made.report["verdict"]["result"], "good");
}

TEST(Features, AdaptiveMeshesKeepThem) {
  RemeshOptions options = bounded(2500);
  options.refinement = Refinement::Adaptive;
  for (const FaceClosure faces : {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles}) {
    options.faces = faces;
    const PolygonSoup solid = shapes::cylinder(48, 3);
    const RemeshResult made = run(solid, options);
    const std::vector<Edge> wanted = sharp_edges(solid), marked = marked_edges(made.final_mesh);
    ASSERT_FALSE(marked.empty());
    const HybridMesh& mesh = made.hierarchy;
    for (const int leaf : mesh.leaves())
      for (int side = 0; side < 4; ++side) EXPECT_FALSE(mesh.is_sharp(leaf, side) && mesh.has_finer_neighbour(leaf, side));
    for (const Edge& e : marked)
      for (const Vec3& end : {e.first, e.second}) {
        double off = 1e300;
        for (const Edge& w : wanted) off = std::min(off, distance_to(w, end));
        EXPECT_LT(off, 1e-9);
      }
    // Chords of the rims.
    EXPECT_NEAR(length_of(marked), length_of(wanted), 0.01 * length_of(wanted));
  }
}

TEST(Features, AreLeftAloneWhereNobodyWantsThem) {
  RemeshOptions options = bounded(1500);
  options.features = Features::None;
  const RemeshResult made = run(shapes::cube(), options);
  EXPECT_TRUE(made.final_mesh.sharp.empty());
  EXPECT_TRUE(made.report["features"].is_null());
  EXPECT_TRUE(run(testing::ball(20), bounded(1500)).final_mesh.sharp.empty());
}

TEST(Features, AGivenAngleDecides) {
  RemeshOptions options = bounded(3000);
  options.features = Features::Given;
  options.feature_angle = 10;
  const PolygonSoup solid = shapes::cylinder(24, 3);
  const RemeshResult made = run(solid, options);
  // The walls' edges too.
  EXPECT_NEAR(length_of(marked_edges(made.final_mesh)), length_of(shapes::sharp_edges(solid.points, solid.indices, solid.offsets, 10)), 1e-6);
}

TEST(Features, TooManyForTheBoundAreLetGoAndThatIsSaid) {
  const RemeshResult made = run(shapes::l_prism(), bounded(30));
  EXPECT_TRUE(made.final_mesh.sharp.empty());
  EXPECT_EQ(made.report["features"]["kept"], false);
  EXPECT_FALSE(made.report["features"]["reason"].get<std::string>().empty());
}

TEST(Features, AreSavedAndReplayed) {
  const PolygonSoup solid = shapes::frame();
  for (const Features features : {Features::Auto, Features::Given}) {
    RemeshOptions options = bounded(2000);
    options.features = features;
    const RemeshResult made = run(solid, options);
    const std::vector<std::uint8_t> bytes = encode_hierarchy(made.hierarchy, "{}");
    const HybridMesh loaded = decode_hierarchy(bytes.data(), bytes.size()).hierarchy;
    EXPECT_EQ(loaded.final_mesh(FaceClosure::Quads).sharp, made.hierarchy.canonical().final_mesh(FaceClosure::Quads).sharp);
    EXPECT_EQ(encode_hierarchy(loaded, "{}"), bytes);
    const RemeshResult again = run(solid, options, made.plan);
    EXPECT_EQ(encode_hierarchy(again.hierarchy, "{}"), bytes);
    EXPECT_EQ(again.plan, made.plan);
    options.threads = 1;
    EXPECT_EQ(encode_hierarchy(run(solid, options).hierarchy, "{}"), bytes);
  }
}

// Between two circles on a ledge there is room for few rows of quads, which must not be pushed across the edges that bound it.
TEST(Features, QuadsStayBetweenThem) {
  const PolygonSoup solid = shapes::stepped_hole(24);
  for (const std::int64_t vertices : {1000, 4000}) {
    const RemeshResult made = run(solid, bounded(vertices));
    testing::expect_sound(made);
    EXPECT_EQ(made.report["verdict"]["result"], "good") << made.report["verdict"];
    EXPECT_LT(made.report["final"]["scaled_jacobian"]["inverted"].get<double>(), 5e-4);
    for (std::size_t f = 0; f < made.final_mesh.face_count(); ++f) {
      std::array<Vec3, 4> p;
      for (int i = 0; i < 4; ++i) p[i] = made.final_mesh.points[made.final_mesh.indices[4 * f + i]];
      const Vec3 middle = (p[0] + p[1] + p[2] + p[3]) / 4, normal = (p[2] - p[0]).cross(p[3] - p[1]).normalized();
      if (std::abs(middle.z() - 1) > 1e-9) continue;
      EXPECT_GT(normal.z(), 0.999);  // the ledge looks up
    }
  }
}

// Vertices at which two boundary edges of one quad meet.
int boundary_corners(const QuadMesh& mesh) {
  std::map<std::pair<int, int>, int> uses;
  const auto vertex = [&](std::size_t f, int i) { return static_cast<int>(mesh.indices[static_cast<std::int64_t>(4 * f) + i % 4]); };
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (int i = 0; i < 4; ++i) ++uses[std::minmax<int>(vertex(f, i), vertex(f, i + 1))];
  int corners = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (int i = 0; i < 4; ++i)
      corners += uses[std::minmax<int>(vertex(f, i), vertex(f, i + 1))] == 1 && uses[std::minmax<int>(vertex(f, i + 1), vertex(f, i + 2))] == 1;
  return corners;
}

// Of each of these solids a wall is missing. Every corner of the hole is on a sharp edge, so that a quad with two sides on the boundary would have a
// straight corner between them.
TEST(Features, TheBoundaryIsOneOfTheCurves) {
  for (const PolygonSoup& solid : {shapes::cube(), shapes::l_prism(), shapes::cylinder(24, 1.5)}) {
    PolygonSoup open = solid;
    const auto begin = open.offsets[open.offsets.size() - 2];
    const std::vector<std::int32_t> missing(open.indices.begin() + begin, open.indices.end());
    open.indices.resize(begin);
    open.offsets.pop_back();
    for (const std::int64_t vertices : {1000, 3000}) {
      const RemeshResult made = run(open, bounded(vertices));
      testing::expect_sound(made);
      EXPECT_EQ(made.report["verdict"]["result"], "good") << made.report["verdict"];
      EXPECT_EQ(boundary_corners(made.final_mesh), 0);
      for (const int corner : missing) {
        double off = 1e300;
        for (const Vec3& p : made.final_mesh.points) off = std::min(off, (p - open.points[corner]).norm());
        EXPECT_LT(off, 1e-12);
      }
    }
  }
}

TEST(Features, APlateKeepsItsCorners) {
  for (const PolygonSoup& plate : {shapes::grid(1, 1), shapes::grid(16, 9)}) {
    const RemeshResult made = run(plate, bounded(600));
    testing::expect_sound(made);
    EXPECT_EQ(made.report["verdict"]["result"], "good") << made.report["verdict"];
    EXPECT_LT(made.report["final"]["hausdorff"].get<double>(), 1e-12);
    EXPECT_EQ(made.report["features"]["corners"], 4);
    EXPECT_EQ(boundary_corners(made.final_mesh), 4);
    EXPECT_TRUE(marked_edges(made.final_mesh).empty());  // its boundary is one already
  }
}

TEST(Features, OpenSolidsHaveBoundaryAndSharpEdges) {
  PolygonSoup open = shapes::l_prism();
  open.indices.resize(open.indices.size() - 4);  // without one wall
  open.offsets.pop_back();
  const RemeshResult made = run(open, bounded(2000));
  testing::expect_sound(made);
  EXPECT_LT(made.report["final"]["l2"].get<double>(), 1e-12);
  const std::vector<Edge> wanted = sharp_edges(open);
  EXPECT_NEAR(length_of(marked_edges(made.final_mesh)), length_of(wanted), 1e-9 * length_of(wanted));
}

}  // namespace
}  // namespace hybrid_mesh
