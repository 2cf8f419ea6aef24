// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/limit_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "subdivision/reference.h"

namespace hybrid_mesh {
namespace {

// Points and normals of a level's vertices, by name.
struct NamedLimit {
  PointMap points, normals;
};

NamedLimit named_limit(const SubdividedMesh& subdivided) {
  const LimitSurface limit = limit_surface(subdivided.hierarchy, subdivided.mesh, subdivided.rules);
  NamedLimit result;
  for (std::size_t v = 0; v < subdivided.mesh.vertex_count(); ++v) {
    result.points[subdivided.mesh.vertex[v]] = limit.points[v];
    result.normals[subdivided.mesh.vertex[v]] = limit.normals[v];
  }
  return result;
}

HybridMesh uniform(HybridMesh mesh, int levels) {
  mesh.refine_uniform(levels);
  return mesh;
}

// A closed base of valences from 3 to n: a double cone of quads over a ring of 2 n.
HybridMesh double_cone(int n) {
  std::vector<std::array<int, 4>> quads;
  for (int i = 0; i < n; ++i) {
    const int a = 2 + 2 * i, b = 2 + (2 * i + 1) % (2 * n), c = 2 + (2 * i + 2) % (2 * n), d = 2 + (2 * i + 2 * n - 1) % (2 * n);
    quads.push_back({0, a, b, c});
    quads.push_back({1, b, a, d});
  }
  return HybridMesh::from_base(2 + 2 * n, quads);
}

// The base's vertices at given places, shaken.
QuadMesh shaken(const HybridMesh& mesh, const std::vector<Vec3>& places, double by, std::mt19937& random) {
  QuadMesh start = mesh.level_mesh(0);
  for (std::size_t v = 0; v < start.vertex_count(); ++v) start.points[v] = places[start.vertex[v].index()] + by * random_point(random);
  return start;
}

const std::vector<Vec3> kCubeCorners = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};

std::vector<Vec3> double_cone_places(int n) {
  std::vector<Vec3> places = {{0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < 2 * n; ++i) places.emplace_back(std::cos(std::numbers::pi * i / n), std::sin(std::numbers::pi * i / n), i % 2 ? -0.3 : 0.3);
  return places;
}

std::vector<Vec3> torus_places(int columns, int rows) {
  std::vector<Vec3> places;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double a = 2 * std::numbers::pi * x / columns, b = 2 * std::numbers::pi * y / rows, r = 2 + std::cos(b);
      places.emplace_back(r * std::cos(a), r * std::sin(a), std::sin(b));
    }
  return places;
}

std::vector<Vec3> grid_places(int columns, int rows) {
  std::vector<Vec3> places;
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x <= columns; ++x) places.emplace_back(x, y, 0);
  return places;
}

TEST(LimitSurface, RegularVerticesAreThoseOfBicubicSplines) {
  constexpr int kColumns = 5, kRows = 4;
  const HybridMesh mesh = grid(kColumns, kRows);
  std::mt19937 random(1);
  QuadMesh level = randomly_placed(mesh.level_mesh(0), random);
  std::array<std::array<Vec3, kColumns + 1>, kRows + 1> p;
  for (std::size_t v = 0; v < level.vertex_count(); ++v)
    p[level.vertex[v].index() / (kColumns + 1)][level.vertex[v].index() % (kColumns + 1)] = level.points[v];
  const auto mean = [](const Vec3& a, const Vec3& b, const Vec3& c) { return Vec3((a + 4 * b + c) / 6); };
  for (const BoundaryRule boundary : {BoundaryRule::EdgesOnly, BoundaryRule::EdgesAndCorners}) {
    CatmullClarkRules rules;
    rules.boundary = boundary;
    const LimitSurface limit = limit_surface(mesh, level, rules);
    for (std::size_t v = 0; v < level.vertex_count(); ++v) {
      const int x = level.vertex[v].index() % (kColumns + 1), y = level.vertex[v].index() / (kColumns + 1);
      const bool at_x = x == 0 || x == kColumns, at_y = y == 0 || y == kRows;
      Vec3 expected = level.points[v];
      if (!at_x && !at_y) {
        const auto row = [&](int j) { return mean(p[j][x - 1], p[j][x], p[j][x + 1]); };
        expected = mean(row(y - 1), row(y), row(y + 1));
        // Derivatives of the splines.
        const auto slope = [&](int j) { return Vec3(p[j][x + 1] - p[j][x - 1]); };
        const Vec3 across = mean(slope(y - 1), slope(y), slope(y + 1)), along = row(y + 1) - row(y - 1);
        EXPECT_LT((limit.normals[v] - across.cross(along).normalized()).norm(), 1e-12);
      } else if (at_x != at_y) {
        expected = at_y ? mean(p[y][x - 1], p[y][x], p[y][x + 1]) : mean(p[y - 1][x], p[y][x], p[y + 1][x]);
      } else if (boundary == BoundaryRule::EdgesOnly) {
        expected = mean(p[y][x == 0 ? 1 : x - 1], p[y][x], p[y == 0 ? 1 : y - 1][x]);
      }
      EXPECT_LT((limit.points[v] - expected).norm(), 1e-13);
    }
  }
}

// The limit of a vertex is the same whichever level it is asked on.
TEST(LimitSurface, RefinementLeavesItWhereItIs) {
  std::vector<Base> all = bases();
  all.push_back({"double cone 5", double_cone(5), 2, 0, true});
  all.push_back({"double cone 8", double_cone(8), 2, 0, true});
  int creased = 0;
  for (const Base& base : all)
    for (unsigned seed = 0; seed < 14; ++seed) {
      SCOPED_TRACE(base.name + " " + std::to_string(seed));
      std::mt19937 random(seed);
      const HybridMesh mesh = uniform(base.mesh, 3);
      SubdividedMesh level{mesh, randomly_placed(mesh.level_mesh(0), random), {}};
      if (seed >= 2) level.rules = random_rules(mesh, level.mesh, BoundaryRule::EdgesOnly, random);
      if (seed % 2) level.rules.boundary = BoundaryRule::EdgesAndCorners;
      creased += !level.rules.creases.empty();
      const double tolerance = seed < 2 ? 1e-12 : 1e-7;  // OpenSubdiv's sharpness is single precision
      NamedLimit coarse = named_limit(level);
      for (int j = 1; j <= 3; ++j) {
        SubdivisionOptions options;
        options.rules = level.rules;
        level = subdivided(mesh, level.mesh, j - 1, j, options);
        NamedLimit fine = named_limit(level);
        for (const auto& [vertex, point] : coarse.points) EXPECT_LT((fine.points[vertex] - point).norm(), tolerance) << j << " " << vertex.code;
        // The two sides of the pillow, and of what few quads wrap up, may fall into one.
        for (const auto& [vertex, normal] : fine.normals) {
          if (!base.simple) break;
          EXPECT_LT(std::abs(normal.norm() - 1), 1e-9) << j << " " << vertex.code;
        }
        coarse = std::move(fine);
      }
    }
  EXPECT_GT(creased, 50);
}

// Vertices at which the surface has a tangent plane: the same normal on every level.
TEST(LimitSurface, RefinementLeavesNormalsAsTheyAre) {
  for (const HybridMesh& base : {cube(), torus(3, 3), double_cone(5), double_cone(7), grid(3, 2)})
    for (const bool creased : {false, true}) {
      std::mt19937 random(11);
      const HybridMesh mesh = uniform(base, 2);
      SubdividedMesh level{mesh, randomly_placed(mesh.level_mesh(0), random), {}};
      // One crease that ends inside, one half-sharp.
      if (creased) level.rules.creases = {{mesh.corner(0, 0), mesh.corner(0, 1), 10}, {mesh.corner(0, 2), mesh.corner(0, 3), 1.5}};
      NamedLimit coarse = named_limit(level);
      for (int j = 1; j <= 2; ++j) {
        SubdivisionOptions options;
        options.rules = level.rules;
        level = subdivided(mesh, level.mesh, j - 1, j, options);
        NamedLimit fine = named_limit(level);
        for (const auto& [vertex, normal] : coarse.normals) EXPECT_LT((fine.normals[vertex] - normal).norm(), 1e-6) << j << " " << vertex.code;
        coarse = std::move(fine);
      }
    }
}

TEST(LimitSurface, NormalsStandOnTheSurface) {
  struct Case {
    HybridMesh base;
    std::vector<Vec3> places;
  };
  for (const auto& [base, places] : {Case{cube(), kCubeCorners},
                                     {torus(4, 4), torus_places(4, 4)},
                                     {double_cone(3), double_cone_places(3)},
                                     {double_cone(5), double_cone_places(5)},
                                     {double_cone(6), double_cone_places(6)},
                                     {grid(4, 3), grid_places(4, 3)}}) {
    const HybridMesh mesh = uniform(base, 6);
    std::mt19937 random(3);
    const QuadMesh start = shaken(mesh, places, 0.2, random);
    double before = 0;
    // The steepest edge at the vertices of level 1, as a sine.
    for (int j = 3; j <= 6; ++j) {
      const SubdividedMesh level = subdivided(mesh, start, 0, j);
      const LimitSurface limit = limit_surface(level.hierarchy, level.mesh, level.rules);
      double steepest = 0;
      for (std::size_t k = 0; k < level.mesh.indices.size(); ++k) {
        const int a = level.mesh.indices[k];
        const int b = level.mesh.indices[k / 4 * 4 + (k + 1) % 4];
        if (mesh.birth_level(level.mesh.vertex[a]) > 1) continue;
        const Vec3 edge = limit.points[b] - limit.points[a];
        steepest = std::max(steepest, std::abs(edge.dot(limit.normals[a])) / edge.norm());
      }
      if (j > 3) {
        EXPECT_LT(steepest, 0.75 * before) << j;
      }
      before = steepest;
    }
    EXPECT_LT(before, 0.1);
  }
}

TEST(LimitSurface, NormalsPointOutwards) {
  const HybridMesh mesh = uniform(cube(), 2);
  std::mt19937 random;
  const QuadMesh start = shaken(mesh, kCubeCorners, 0, random);
  std::vector<CatmullClarkRules> all(4);
  for (int s = 0; s < 4; ++s) all[1].creases.push_back({mesh.corner(1, s), mesh.corner(1, (s + 1) % 4), 10});
  for (const int node : start.node)
    for (int s = 0; s < 4; ++s) all[2].creases.push_back({mesh.corner(node, s), mesh.corner(node, (s + 1) % 4), 10});
  all[3].creases = {{mesh.corner(1, 0), mesh.corner(1, 1), 10}, {mesh.corner(0, 0), mesh.corner(0, 1), 0.5}};
  all[3].vertices = {{mesh.corner(2, 2), 10}, {mesh.corner(1, 2), 1.25}};
  for (const CatmullClarkRules& rules : all)
    for (int j = 0; j <= 2; ++j) {
      SubdivisionOptions options;
      options.rules = rules;
      const SubdividedMesh level = subdivided(mesh, start, 0, j, options);
      const LimitSurface limit = limit_surface(level.hierarchy, level.mesh, level.rules);
      for (std::size_t v = 0; v < level.mesh.vertex_count(); ++v) EXPECT_GT(limit.normals[v].dot(limit.points[v].normalized()), 0.5);
    }
  // With every edge sharp it is the cube itself, and the normals are means of those of its sides.
  SubdivisionOptions options;
  options.rules = all[2];
  const SubdividedMesh level = subdivided(mesh, start, 0, 2, options);
  const LimitSurface limit = limit_surface(level.hierarchy, level.mesh, level.rules);
  for (std::size_t v = 0; v < level.mesh.vertex_count(); ++v) {
    const Vec3& p = limit.points[v];
    EXPECT_NEAR(p.cwiseAbs().maxCoeff(), 1, 1e-13);
    Vec3 expected = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (std::abs(std::abs(p[k]) - 1) < 1e-13) expected[k] = p[k];
    EXPECT_LT((limit.normals[v] - expected.normalized()).norm(), 1e-12);
  }
}

TEST(LimitSurface, SharpCreasesAreSplineCurves) {
  // A closed crease around a torus, one along the boundary of nothing else, both of infinite sharpness.
  const HybridMesh mesh = uniform(torus(5, 4), 2);
  std::mt19937 random(6);
  const QuadMesh start = randomly_placed(mesh.level_mesh(0), random);
  SubdivisionOptions options;
  std::array<Vec3, 5> p;
  for (int x = 0; x < 5; ++x) options.rules.creases.push_back({mesh.corner(x, 0), mesh.corner(x, 1), std::numeric_limits<double>::infinity()});
  for (std::size_t v = 0; v < start.vertex_count(); ++v)
    if (start.vertex[v].index() < 5) p[start.vertex[v].index()] = start.points[v];
  const auto spline = [&](int i, double t) {  // between p[i] and p[i + 1]
    const Vec3 &a = p[(i + 4) % 5], &b = p[i % 5], &c = p[(i + 1) % 5], &d = p[(i + 2) % 5];
    const double s = 1 - t;
    return Vec3((s * s * s * a + (4 - 6 * t * t + 3 * t * t * t) * b + (4 - 6 * s * s + 3 * s * s * s) * c + t * t * t * d) / 6);
  };
  const SubdividedMesh level = subdivided(mesh, start, 0, 2, options);
  NamedLimit limit = named_limit(level);
  for (int x = 0; x < 5; ++x) {
    const int node = mesh.first_child(x), last = mesh.first_child(x) + 1;
    const VertexId quarters[5] = {mesh.corner(x, 0), mesh.corner(mesh.first_child(node), 1), mesh.corner(node, 1),
                                  mesh.corner(mesh.first_child(last), 1), mesh.corner(x, 1)};
    for (int k = 0; k <= 4; ++k) EXPECT_LT((limit.points[quarters[k]] - spline(x, k / 4.0)).norm(), 1e-13);
  }
}

TEST(LimitSurface, OpenBoundariesAreSplineCurves) {
  // What lies inside has no say.
  HybridMesh mesh = uniform(cube(), 1);
  ASSERT_EQ(mesh.apply(opening(mesh, {mesh.first_child(2) + 1})), "");
  mesh.refine_uniform(3);
  std::mt19937 random(2);
  const QuadMesh start = randomly_placed(mesh.level_mesh(1), random);
  QuadMesh other = randomly_placed(start, random);
  std::array<Vec3, 4> p;
  const int removed = mesh.first_child(2) + 1;
  for (std::size_t v = 0; v < start.vertex_count(); ++v)
    for (int i = 0; i < 4; ++i)
      if (start.vertex[v] == mesh.corner(removed, i)) p[i] = other.points[v] = start.points[v];
  const SubdividedMesh a = subdivided(mesh, start, 1, 3), b = subdivided(mesh, other, 1, 3);
  NamedLimit first = named_limit(a), second = named_limit(b);
  for (int i = 0; i < 4; ++i) {
    const VertexId corner = mesh.corner(removed, i);
    EXPECT_LT((first.points[corner] - (p[(i + 3) % 4] + 4 * p[i] + p[(i + 1) % 4]) / 6).norm(), 1e-13);
    EXPECT_LT((first.points[corner] - second.points[corner]).norm(), 1e-13);
    const VertexId middle(VertexId::Kind::Edge, mesh.half_edge(removed, i) >> 1);
    EXPECT_LT((first.points[middle] - (p[(i + 3) % 4] + 23 * p[i] + 23 * p[(i + 1) % 4] + p[(i + 2) % 4]) / 48).norm(), 1e-13);
  }
}

TEST(LimitSurface, ItMovesWithTheMesh) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 shift(1000, -2000, 500);
  const HybridMesh mesh = uniform(cube(), 1);
  std::mt19937 random(9);
  QuadMesh start = randomly_placed(mesh.level_mesh(1), random);
  const CatmullClarkRules rules = random_rules(mesh, start, BoundaryRule::EdgesOnly, random);
  const LimitSurface here = limit_surface(mesh, start, rules), there = limit_surface(mesh, transformed(start, rotation, shift), rules);
  for (std::size_t v = 0; v < start.vertex_count(); ++v) {
    EXPECT_LT((rotation * here.points[v] + shift - there.points[v]).norm(), 1e-9);
    EXPECT_LT((rotation * here.normals[v] - there.normals[v]).norm(), 1e-7);
  }
}

TEST(LimitSurface, BadInputIsRefused) {
  HybridMesh mesh = uniform(cube(), 2);
  const CatmullClarkRules none;
  QuadMesh level = mesh.level_mesh(1);
  EXPECT_NO_THROW(limit_surface(mesh, level, none));
  level.points.pop_back();
  EXPECT_THROW(limit_surface(mesh, level, none), Error);
  EXPECT_THROW(limit_surface(mesh, QuadMesh(), none), Error);
  level = mesh.level_mesh(1);
  level.node[0] = 100000;
  EXPECT_THROW(limit_surface(mesh, level, none), Error);
  level.node[0] = level.node[1];
  EXPECT_THROW(limit_surface(mesh, level, none), Error);
  CatmullClarkRules wrong;
  wrong.vertices = {{VertexId(VertexId::Kind::Free, 0), -1}};
  EXPECT_THROW(limit_surface(mesh, mesh.level_mesh(1), wrong), Error);
  mesh.refine_balanced(mesh.leaves()[3]);
  for (const FaceClosure closure : {FaceClosure::Quads, FaceClosure::Transition, FaceClosure::Triangles})
    EXPECT_THROW(limit_surface(mesh, mesh.final_mesh(closure), none), Error);
  // A sphere of one quad, two of its sides glued to the other two: two vertices of valence 1.
  const HybridMesh folded = HybridMesh::from_base(3, {{0, 1, 2, 1}}, {{SideLink{0, 3}, SideLink{0, 2}, SideLink{0, 1}, SideLink{0, 0}}});
  try {
    limit_surface(folded, folded.level_mesh(0), none);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Unsupported);
  }
}

}  // namespace
}  // namespace hybrid_mesh
