// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/catmull_clark.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "subdivision/reference.h"

namespace hybrid_mesh {
namespace {

constexpr double kRounding = 1e-13;
constexpr double kSharpnessRounding = 1e-7;  // OpenSubdiv's sharpness is single precision

testing::AssertionResult same_points(const QuadMesh& mesh, const PointMap& expected, double tolerance = kRounding) {
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const auto found = expected.find(mesh.vertex[v]);
    if (found == expected.end()) return testing::AssertionFailure() << "vertex " << v << " is not expected";
    const double distance = (found->second - mesh.points[v]).norm();
    if (!(distance < tolerance)) return testing::AssertionFailure() << "vertex " << v << " is off by " << distance;
  }
  return testing::AssertionSuccess();
}

testing::AssertionResult same_mesh(const QuadMesh& a, const QuadMesh& b, double tolerance = kRounding) {
  if (a.indices != b.indices || a.vertex != b.vertex || a.node != b.node) return testing::AssertionFailure() << "different connectivity";
  for (std::size_t v = 0; v < a.vertex_count(); ++v)
    if (!((a.points[v] - b.points[v]).norm() < tolerance))
      return testing::AssertionFailure() << "vertex " << v << " is off by " << (a.points[v] - b.points[v]).norm();
  return testing::AssertionSuccess();
}

// The same position for the same vertex, whatever else the meshes have.
int common_vertices(const QuadMesh& a, const QuadMesh& b, double tolerance) {
  PointMap points;
  for (std::size_t v = 0; v < a.vertex_count(); ++v) points[a.vertex[v]] = a.points[v];
  int common = 0;
  for (std::size_t v = 0; v < b.vertex_count(); ++v) {
    const auto found = points.find(b.vertex[v]);
    if (found == points.end()) continue;
    ++common;
    EXPECT_LT((found->second - b.points[v]).norm(), tolerance);
  }
  return common;
}

TEST(CatmullClark, AStepIsThatOfTheBook) {
  for (const Base& base : bases())
    for (const BoundaryRule boundary : {BoundaryRule::EdgesOnly, BoundaryRule::EdgesAndCorners})
      for (int level = 0; level <= 2; ++level) {
        SCOPED_TRACE(base.name + " " + std::to_string(level));
        std::mt19937 random(level);
        HybridMesh mesh = base.mesh;
        mesh.refine_uniform(level + 1);
        const QuadMesh start = randomly_placed(mesh.level_mesh(level), random);
        SubdivisionOptions options;
        options.rules.boundary = boundary;
        const SubdividedMesh result = subdivided(mesh, start, level, level + 1, options);
        ReferenceSharpness none;
        EXPECT_EQ(result.mesh.indices, mesh.level_mesh(level + 1).indices);
        EXPECT_TRUE(same_points(result.mesh, reference_step(mesh, start, boundary, none)));
        EXPECT_TRUE(result.rules.creases.empty() && result.rules.vertices.empty());
      }
}

TEST(CatmullClark, SharpFeaturesAreThoseOfTheBook) {
  for (const Base& base : bases())
    for (unsigned seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE(base.name + " " + std::to_string(seed));
      const BoundaryRule boundary = seed % 2 ? BoundaryRule::EdgesOnly : BoundaryRule::EdgesAndCorners;
      std::mt19937 random(seed);
      const int from = base.simple ? 0 : 1;
      HybridMesh mesh = base.mesh;
      mesh.refine_uniform(from + 4);
      const QuadMesh start = randomly_placed(mesh.level_mesh(from), random);
      QuadMesh level = start;
      SubdivisionOptions options;
      options.rules = random_rules(mesh, start, boundary, random);
      ReferenceSharpness sharpness = reference_sharpness(mesh, level, options.rules);
      SubdividedMesh step{mesh, level, options.rules};
      for (int j = from + 1; j <= from + 4; ++j) {
        const PointMap expected = reference_step(mesh, level, boundary, sharpness);
        // All levels at once, and the one level from the rules that the last one left.
        EXPECT_TRUE(same_points(subdivided(mesh, start, from, j, options).mesh, expected, kSharpnessRounding));
        SubdivisionOptions next;
        next.rules = step.rules;
        step = subdivided(mesh, step.mesh, j - 1, j, next);
        EXPECT_TRUE(same_points(step.mesh, expected, kSharpnessRounding));
        level = step.mesh;
      }
    }
}

TEST(CatmullClark, OperationsStandBetweenTheSteps) {
  for (const HybridMesh& base : {cube(), grid(3, 2), torus(3, 3)})
    for (const bool creased : {false, true}) {
      HybridMesh mesh = with_operations(base);
      std::mt19937 random(5);
      QuadMesh level = randomly_placed(mesh.level_mesh(0), random);
      for (int j = 1; j <= 2; ++j) mesh.set_level_positions(j, randomly_placed(mesh.level_mesh(j), random));
      const QuadMesh start = level;
      const double tolerance = creased ? kSharpnessRounding : kRounding;
      SubdivisionOptions options;
      if (creased) options.rules = random_rules(mesh, level, BoundaryRule::EdgesOnly, random);
      ReferenceSharpness sharpness = reference_sharpness(mesh, level, options.rules);
      for (int j = 1; j <= 4; ++j) {
        if (j == 4) mesh.refine_uniform(4);
        PointMap expected = reference_step(mesh, level, BoundaryRule::EdgesOnly, sharpness);
        options.last = LevelKind::M;
        EXPECT_TRUE(same_points(subdivided(mesh, start, 0, j, options).mesh, expected, tolerance)) << j;
        // What subdivision does not place has its stored position.
        level = mesh.level_mesh(j);
        std::size_t stored = 0;
        for (std::size_t v = 0; v < level.vertex_count(); ++v) stored += expected.try_emplace(level.vertex[v], level.points[v]).second;
        EXPECT_EQ(stored, std::vector<std::size_t>({4, 8, 0, 0})[j - 1]);
        options.last = LevelKind::N;
        const SubdividedMesh result = subdivided(mesh, start, 0, j, options);
        EXPECT_EQ(result.mesh.indices, level.indices);
        EXPECT_TRUE(same_points(result.mesh, expected, tolerance)) << j;
        level = result.mesh;
      }
    }
}

// Whatever was done to a hierarchy: refined here and there, changed at several levels, with some of the operations switched off.
TEST(CatmullClark, AnyHierarchyIsSubdividedByTheBook) {
  int applied = 0, skipped = 0;
  for (const Base& base : bases())
    for (unsigned seed = 0; seed < 15; ++seed) {
      SCOPED_TRACE(base.name + " " + std::to_string(seed));
      HybridMesh mesh = base.mesh;
      mesh.refine_uniform(1);
      std::mt19937 random(seed);
      for (int step = 0; step < 8; ++step) {
        const std::vector<int> leaves = mesh.leaves(), candidates = active_nodes(mesh, 1 + static_cast<int>(random() % 3));
        const auto any = [&] { return candidates[random() % candidates.size()]; };
        if (step % 2 || candidates.empty()) {
          const int leaf = leaves[random() % leaves.size()];
          if (mesh.level(leaf) < 4) mesh.refine_balanced(leaf);
          continue;
        }
        const auto kind = random() % 3;
        const Repatch repatch = kind == 0   ? cube_on(mesh, any())
                                : kind == 1 ? opening(mesh, {any()})
                                            : tube_between(mesh, any(), any(), static_cast<int>(random() % 4));
        applied += mesh.apply(repatch).empty();
        mesh.balance();
      }
      SubdivisionOptions options;
      options.operation_vertices = OperationVertices::Harmonic;
      std::vector<bool> wanted(mesh.operation_count());
      for (std::size_t o = 0; o < wanted.size(); ++o) wanted[o] = random() % 4 > 0;
      SubdividedMesh step;
      try {
        options.operations = wanted;
        step = subdivided(mesh, randomly_placed(mesh.level_mesh(0), random), 0, 0, options);
      } catch (const Error&) {  // operations that are no manifold without the others
        ++skipped;
        continue;
      }
      options.operations.reset();
      options.rules = random_rules(step.hierarchy, step.mesh, BoundaryRule::EdgesOnly, random);
      ReferenceSharpness sharpness = reference_sharpness(step.hierarchy, step.mesh, options.rules);
      for (int j = 1; j <= 4; ++j) {
        options.last = LevelKind::M;
        const SubdividedMesh before = subdivided(step.hierarchy, step.mesh, j - 1, j, options);
        EXPECT_TRUE(same_points(before.mesh, reference_step(before.hierarchy, step.mesh, BoundaryRule::EdgesOnly, sharpness), kSharpnessRounding))
            << j;
        options.last = LevelKind::N;
        step = subdivided(step.hierarchy, step.mesh, j - 1, j, options);
        EXPECT_GT(common_vertices(before.mesh, step.mesh, 1e-15), 0);
        options.rules = step.rules;
      }
    }
  EXPECT_GT(applied, 100);
  EXPECT_LT(skipped, 10);
}

TEST(CatmullClark, EverythingMovesWithTheMesh) {
  const Eigen::Matrix3d linear = (Eigen::Matrix3d() << 1.5, 0.3, -0.2, 0.1, -0.8, 0.4, 0.6, 0.2, 1.1).finished();
  const Vec3 shift(3, -4, 5);
  HybridMesh mesh = with_operations(cube());
  std::mt19937 random(2);
  const QuadMesh start = randomly_placed(mesh.level_mesh(0), random);
  SubdivisionOptions options;
  options.operation_vertices = OperationVertices::Harmonic;
  options.rules = random_rules(mesh, start, BoundaryRule::EdgesOnly, random);
  const SubdividedMesh here = subdivided(mesh, start, 0, 4, options), there = subdivided(mesh, transformed(start, linear, shift), 0, 4, options);
  EXPECT_TRUE(same_mesh(transformed(here.mesh, linear, shift), there.mesh, 1e-11));
}

TEST(CatmullClark, APlaneStaysAPlane) {
  const Vec3 normal = Vec3(1, 2, -3).normalized();
  for (const HybridMesh& base : {grid(3, 2), cube()}) {
    const HybridMesh mesh = with_operations(base);
    std::mt19937 random(3);
    QuadMesh start = randomly_placed(mesh.level_mesh(0), random);
    for (Vec3& point : start.points) point += (2 - point.dot(normal)) * normal;
    SubdivisionOptions options;
    options.rules = random_rules(mesh, start, BoundaryRule::EdgesAndCorners, random);
    for (const Vec3& point : subdivided(mesh, start, 0, 4, options).mesh.points) EXPECT_NEAR(point.dot(normal), 2, kRounding);
  }
}

TEST(CatmullClark, SkippedOperationsLeaveTheRegularResult) {
  const HybridMesh mesh = with_operations(torus(3, 3));
  HybridMesh regular = torus(3, 3);
  regular.refine_uniform(3);
  std::mt19937 random(8);
  const QuadMesh start = randomly_placed(mesh.level_mesh(0), random);
  const QuadMesh expected = subdivided(regular, start, 0, 3).mesh;
  SubdivisionOptions options;
  options.operations = operations_below(mesh, 1);
  EXPECT_EQ(options.operations, std::vector<bool>(4, false));
  const SubdividedMesh without = subdivided(mesh, start, 0, 3, options);
  EXPECT_EQ(without.mesh.indices, expected.indices);
  for (std::size_t v = 0; v < expected.vertex_count(); ++v) EXPECT_LT((without.mesh.points[v] - expected.points[v]).norm(), kRounding);
  EXPECT_TRUE(find_defects(without.hierarchy).empty());

  // The second operation stands on the first, the others do not.
  EXPECT_EQ(mesh.operation(1).depends, std::vector<int>{0});
  options.operations = std::vector<bool>{false, true, true, true};
  EXPECT_EQ(subdivided(mesh, start, 0, 3, options).hierarchy.enabled(), (std::vector<bool>{false, false, true, true}));
  options.operations = operations_below(mesh, 2);
  EXPECT_EQ(options.operations, (std::vector<bool>{true, false, false, false}));
  const SubdividedMesh first = subdivided(mesh, start, 0, 3, options);
  EXPECT_EQ(first.mesh.face_count(), 16 * (mesh.level_mesh(1).face_count()));
  // Switched off beforehand is the same.
  HybridMesh disabled = mesh;
  ASSERT_EQ(disabled.set_enabled(*options.operations), "");
  EXPECT_TRUE(same_mesh(subdivided(disabled, start, 0, 3).mesh, first.mesh));

  // From a level after the skipped operations, what they removed is filled in; after ones that were disabled, what they make.
  for (const HybridMesh& given : {mesh, disabled})
    for (const std::vector<bool>& chosen : {operations_below(mesh, 1), mesh.enabled()}) {
      QuadMesh level = randomly_placed(given.level_mesh(2), random);
      for (Vec3& point : level.points) point.x() = -3;
      options.operations = chosen;
      const SubdividedMesh result = subdivided(given, level, 2, 2, options);
      EXPECT_GT(common_vertices(level, result.mesh, kRounding), 100);
      for (const Vec3& point : result.mesh.points) EXPECT_NEAR(point.x(), -3, kRounding);
    }
}

TEST(CatmullClark, AdaptiveHierarchiesAreContinuedUniformly) {
  HybridMesh uniform = with_operations(cube());
  HybridMesh adaptive = uniform;
  uniform.refine_uniform(5);
  for (const int leaf : {3, 3, 40}) adaptive.refine_balanced(adaptive.leaves()[leaf]);
  ASSERT_FALSE(adaptive.conforming());
  std::mt19937 random(4);
  const QuadMesh start = randomly_placed(uniform.level_mesh(0), random);
  const SubdividedMesh a = subdivided(uniform, start, 0, 5), b = subdivided(adaptive, start, 0, 5);
  ASSERT_EQ(a.mesh.indices, b.mesh.indices);
  EXPECT_TRUE(std::equal(a.mesh.points.begin(), a.mesh.points.end(), b.mesh.points.begin(),
                         [](const Vec3& p, const Vec3& q) { return (p - q).norm() < kRounding; }));
  EXPECT_TRUE(find_defects(b.hierarchy).empty());
  // What both have is named the same.
  EXPECT_GT(common_vertices(subdivided(uniform, start, 0, 3).mesh, subdivided(adaptive, start, 0, 3).mesh, kRounding), 100);

  // From a level with hanging nodes, vertices that it does not have are filled in: on a plane they lie in it.
  for (const FaceClosure closure : {FaceClosure::Quads, FaceClosure::Transition}) {
    QuadMesh level = randomly_placed(adaptive.level_mesh(5, LevelKind::N, closure), random);
    for (Vec3& point : level.points) point.z() = 1;
    const SubdividedMesh result = subdivided(adaptive, level, 5, 5);
    const int common = common_vertices(level, result.mesh, kRounding);
    EXPECT_GT(common, 100);
    EXPECT_LT(common, static_cast<int>(result.mesh.vertex_count()));
    for (const Vec3& point : result.mesh.points) EXPECT_NEAR(point.z(), 1, kRounding);
    EXPECT_TRUE(result.hierarchy.conforming());
  }
}

TEST(CatmullClark, OperationVerticesAreWhereTheyAreAskedFor) {
  HybridMesh mesh = with_operations(cube());
  std::mt19937 random(6);
  const QuadMesh start = randomly_placed(mesh.level_mesh(0), random);
  const auto run = [&](OperationVertices where, const Vec3& shift = Vec3::Zero()) {
    SubdivisionOptions options;
    options.operation_vertices = where;
    return subdivided(mesh, transformed(start, Eigen::Matrix3d::Identity(), shift), 0, 1, options).mesh;
  };
  const auto made_here = [&](const QuadMesh& level, std::size_t v) {
    return level.vertex[v].kind() == VertexId::Kind::Free && level.vertex[v].index() >= mesh.base_vertex_count();
  };
  const auto neighbours = [](const QuadMesh& level, std::size_t v) {
    std::set<int> result;
    for (std::size_t k = 0; k < level.indices.size(); ++k)
      if (level.indices[k] == static_cast<int>(v)) {
        result.insert(level.indices[k / 4 * 4 + (k + 1) % 4]);
        result.insert(level.indices[k / 4 * 4 + (k + 3) % 4]);
      }
    return result;
  };
  // Nothing is known of them: the mean of their neighbours, in every way.
  for (const OperationVertices where : {OperationVertices::Stored, OperationVertices::Carried, OperationVertices::Harmonic}) {
    const QuadMesh level = run(where);
    int made = 0;
    for (std::size_t v = 0; v < level.vertex_count(); ++v) {
      if (!made_here(level, v)) continue;
      ++made;
      Vec3 mean = Vec3::Zero();
      const std::set<int> around = neighbours(level, v);
      for (const int w : around) mean += level.points[w] / static_cast<double>(around.size());
      EXPECT_LT((level.points[v] - mean).norm(), kRounding);
    }
    EXPECT_EQ(made, 4);
  }
  // Kept for the level, one of them at the origin, which is as good a position as any.
  const auto check = [&](const QuadMesh& own) {
    const Vec3 shift(4, 5, 6);
    const QuadMesh stored = run(OperationVertices::Stored, shift), carried = run(OperationVertices::Carried),
                   moved = run(OperationVertices::Carried, shift);
    for (std::size_t v = 0; v < own.vertex_count(); ++v) {
      if (made_here(own, v)) {
        EXPECT_LT((stored.points[v] - own.points[v]).norm(), kRounding);
      }
      EXPECT_LT((moved.points[v] - carried.points[v] - shift).norm(), 1e-12);
    }
  };
  QuadMesh own = randomly_placed(mesh.level_mesh(1), random);
  for (std::size_t v = own.vertex_count(); v-- > 0;)
    if (made_here(own, v)) {
      own.points[v].setZero();
      break;
    }
  mesh.set_level_positions(1, own);
  check(own);
  // A mesh that is where subdivision puts it is carried nowhere.
  QuadMesh there = run(OperationVertices::Harmonic);
  for (std::size_t v = 0; v < there.vertex_count(); ++v)
    if (made_here(there, v)) there.points[v] = random_point(random);
  mesh.set_level_positions(1, there);
  EXPECT_TRUE(same_mesh(run(OperationVertices::Carried), there));
  // Out of maps.
  mesh.clear_positions();
  for (const int root : mesh.roots()) {
    const Vec3 corner = random_point(random);
    mesh.set_map(root, make_map(2, 0, 1, [&](double u, double v) { return Vec3(corner + Vec3(u, v, u * v)); }));
  }
  check(mesh.level_mesh(1));
}

TEST(CatmullClark, AComponentThatAnOperationMakesNeedsPositions) {
  HybridMesh mesh = grid(2, 2);
  mesh.refine_uniform(1);
  Repatch island;
  island.level = 1;
  island.removed = {};
  island.new_vertices = 8;
  island.quads = {{-1, -4, -3, -2}, {-5, -6, -7, -8}, {-1, -2, -6, -5}, {-2, -3, -7, -6}, {-3, -4, -8, -7}, {-4, -1, -5, -8}};
  ASSERT_EQ(mesh.apply(island), "");
  std::mt19937 random(1);
  const QuadMesh start = randomly_placed(mesh.level_mesh(0), random);
  EXPECT_THROW(subdivided(mesh, start, 0, 1), Error);
  mesh.set_level_positions(1, randomly_placed(mesh.level_mesh(1), random));
  EXPECT_EQ(subdivided(mesh, start, 0, 2).mesh.face_count(), 4 * mesh.level_mesh(1).face_count());
}

TEST(CatmullClark, ACreaseEndsWhereItsEdgeIsRemoved) {
  HybridMesh mesh = grid(4, 1);
  mesh.refine_uniform(1);
  // The line across the second edge is a crease; at level 1 a part of it is inside what two quads' removal takes away.
  const int left = mesh.first_child(1) + 1, right = mesh.first_child(2);
  Repatch repatch;
  repatch.level = 1;
  repatch.removed = {left, right};
  for (const auto& [node, corner] : {std::pair(left, 0), {left, 1}, {right, 1}, {right, 2}, {right, 3}, {left, 3}})
    repatch.boundary.push_back(mesh.corner(node, corner));
  repatch.new_vertices = 2;
  repatch.quads = {{0, 1, -1, 5}, {1, 2, -2, -1}, {2, 3, 4, -2}, {-1, -2, 4, 5}};
  ASSERT_EQ(mesh.apply(repatch), "");
  std::mt19937 random(9);
  const QuadMesh start = randomly_placed(mesh.level_mesh(0), random);
  SubdivisionOptions options;
  options.rules.creases = {{start.vertex[0], start.vertex[1], 3}, {mesh.corner(2, 0), mesh.corner(2, 3), 4}};
  options.last = LevelKind::M;
  EXPECT_EQ(subdivided(mesh, start, 0, 1, options).rules.creases.size(), 4u);
  options.last = LevelKind::N;
  const CatmullClarkRules after = subdivided(mesh, start, 0, 1, options).rules;
  ASSERT_EQ(after.creases.size(), 3u);
  EXPECT_EQ(std::count_if(after.creases.begin(), after.creases.end(), [](const Crease& crease) { return crease.sharpness == 3; }), 1);
  EXPECT_EQ(subdivided(mesh, start, 0, 2, options).rules.creases.size(), 6u);
}

TEST(CatmullClark, BadInputIsRefused) {
  const HybridMesh mesh = with_operations(cube());
  std::mt19937 random(7);
  const QuadMesh start = randomly_placed(mesh.level_mesh(1), random);
  const auto message = [&](const QuadMesh& given, int from, int to, const SubdivisionOptions& options) -> std::string {
    try {
      subdivided(mesh, given, from, to, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
      return error.what();
    }
    return "no error";
  };
  const auto says = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  const auto with_rules = [&](CatmullClarkRules rules) {
    SubdivisionOptions options;
    options.rules = std::move(rules);
    return message(start, 1, 2, options);
  };
  EXPECT_EQ(message(start, 1, 2, {}), "no error");
  EXPECT_TRUE(says(message(start, 2, 1, {}), "from level 2 to level 1"));
  EXPECT_TRUE(says(message(start, -1, 1, {}), "level -1"));
  EXPECT_TRUE(says(message(start, 1, HybridMesh::max_level + 1, {}), "level 25"));
  EXPECT_TRUE(says(message(start, 2, 3, {}), "lacks"));
  QuadMesh other = start;
  other.points.pop_back();
  EXPECT_TRUE(says(message(other, 1, 2, {}), "differ in number"));
  other = start;
  other.points[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(says(message(other, 1, 2, {}), "position 3"));
  other = start;
  other.points.pop_back();
  other.vertex.pop_back();
  EXPECT_TRUE(says(message(other, 1, 2, {}), "lacks 1 of"));
  other.points.push_back(Vec3::Zero());
  other.vertex.push_back(VertexId());
  EXPECT_TRUE(says(message(other, 1, 2, {}), "lacks 1 of"));

  const VertexId a = mesh.corner(start.node[0], 0), b = mesh.corner(start.node[0], 1), opposite = mesh.corner(start.node[0], 2);
  const VertexId finer(VertexId::Kind::Node, mesh.first_child(start.node[0]));
  VertexId nonsense;
  nonsense.code = 7;
  EXPECT_EQ(with_rules({{}, {{a, b, 1}}, {{a, 0.5}}}), "no error");
  EXPECT_EQ(with_rules({{}, {{b, a, std::numeric_limits<double>::infinity()}}, {}}), "no error");
  EXPECT_TRUE(says(with_rules({{}, {{a, b, 1}, {a, opposite, 1}}, {}}), "crease 1"));
  for (const VertexId wrong : {a, finer, VertexId(), nonsense, VertexId(VertexId::Kind::Edge, 1 << 28)})
    EXPECT_TRUE(says(with_rules({{}, {{a, wrong, 1}}, {}}), "no edge"));
  EXPECT_TRUE(says(with_rules({{}, {{VertexId(), VertexId(), 1}}, {}}), "no edge"));
  EXPECT_TRUE(says(with_rules({{}, {}, {{finer, 1}}}), "no vertex"));
  for (const double wrong : {-0.5, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(says(with_rules({{}, {{a, b, wrong}}, {}}), "sharpness of crease 0"));
    EXPECT_TRUE(says(with_rules({{}, {}, {{a, wrong}}}), "sharpness of sharp vertex 0"));
  }

  SubdivisionOptions options;
  options.operations = std::vector<bool>(3, true);
  EXPECT_TRUE(says(message(start, 1, 2, options), "3 choices for 4 operations"));
  options = {};
  options.last = LevelKind::M;
  EXPECT_TRUE(says(message(start, 1, 1, options), "M1"));
}

TEST(CatmullClark, MoreQuadsThanCanBeHeldAreRefused) {
  const HybridMesh mesh = cube();
  const QuadMesh start = mesh.level_mesh(0);
  for (const int level : {11, HybridMesh::max_level}) {
    try {
      subdivided(mesh, start, 0, level);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Unsupported);
    }
  }
}

TEST(CatmullClark, ItCanBeCancelled) {
  Context context;
  context.cancel();
  const HybridMesh mesh = cube();
  try {
    subdivide(mesh, mesh.level_mesh(0), 0, 3, {}, Progress(context));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::Cancelled);
  }
  Context other;
  subdivide(mesh, mesh.level_mesh(0), 0, 3, {}, Progress(other));
  EXPECT_EQ(other.progress(), 1);
}

}  // namespace
}  // namespace hybrid_mesh
