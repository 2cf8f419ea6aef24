// SPDX-License-Identifier: GPL-3.0-or-later
#include "wavelets/wavelet_step.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "base/error.h"
#include "wavelets/hierarchies.h"
#include "wavelets/step_matrices.h"

namespace hybrid_mesh {
namespace {

constexpr double kRounding = 1e-12;

LevelAnalysis transformed(LevelAnalysis analysis, const Eigen::Matrix3d& linear, const Vec3& shift) {
  for (Vec3& point : analysis.coarse) point = linear * point + shift;
  for (auto* vectors : {&analysis.details, &analysis.remainder})
    for (Vec3& vector : *vectors) vector = linear * vector;
  return analysis;
}

LevelAnalysis without_details(const WaveletStep& step, const std::vector<Vec3>& coarse) {
  return {coarse, std::vector<Vec3>(step.details().size(), Vec3::Zero()), {}};
}

TEST(WaveletStep, ReconstructionIsPerfect) {
  for (const Hierarchy& tried : hierarchies())
    for (const BoundaryRule boundary : {BoundaryRule::EdgesOnly, BoundaryRule::EdgesAndCorners}) {
      SCOPED_TRACE(tried.name);
      std::mt19937 random(7);
      for (int level = 1; level <= tried.mesh.depth(); ++level) {
        const WaveletStep step(tried.mesh, level, boundary);
        const std::vector<Vec3> points = randomly_placed(step.fine(), random).points;
        EXPECT_LT(farthest(step.synthesise(step.analyse(points)), points), kRounding) << level;
      }
    }
}

TEST(WaveletStep, SynthesisIsAMatrix) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int level = 1; level <= tried.mesh.depth(); ++level) {
      const WaveletStep step(tried.mesh, level);
      LevelAnalysis analysis{randomly_placed(step.coarse(), random).points, {}, {}};
      for (std::size_t d = 0; d < step.details().size(); ++d) analysis.details.emplace_back(uniform(random), uniform(random), uniform(random));
      Eigen::MatrixX3d both(static_cast<Eigen::Index>(analysis.coarse.size() + analysis.details.size()), 3);
      for (Eigen::Index i = 0; i < both.rows(); ++i) {
        const auto detail = i - static_cast<Eigen::Index>(analysis.coarse.size());
        both.row(i) = (detail < 0 ? analysis.coarse[i] : analysis.details[detail]).transpose();
      }
      const Eigen::MatrixX3d product = step.synthesis() * both;
      std::vector<Vec3> points;
      for (Eigen::Index i = 0; i < product.rows(); ++i) points.emplace_back(product.row(i).transpose());
      EXPECT_LT(farthest(points, step.synthesise(analysis)), kRounding) << level;
    }
  }
}

TEST(WaveletStep, AllLevelsTogetherGiveTheFinalMeshBack) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    std::mt19937 random(11);
    const std::vector<Vec3> points = randomly_placed(tried.mesh.final_mesh(), random).points;
    std::vector<WaveletStep> steps;
    for (int level = 1; level <= tried.mesh.depth(); ++level) steps.emplace_back(tried.mesh, level);
    ASSERT_EQ(steps.back().fine().vertex, tried.mesh.final_mesh().vertex);
    std::vector<LevelAnalysis> analyses(steps.size());
    std::vector<Vec3> low = points;
    for (std::size_t i = steps.size(); i-- > 0;) {
      analyses[i] = steps[i].analyse(low);
      low = analyses[i].coarse;
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
      analyses[i].coarse = low;
      low = steps[i].synthesise(analyses[i]);
    }
    // A step may take an error of the one before to one ten times as large.
    EXPECT_LT(farthest(low, points), 1e-11);
  }
}

TEST(WaveletStep, ThereIsADetailForEveryVertexThatComesUp) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    for (int level = 1; level <= tried.mesh.depth(); ++level) {
      const WaveletStep step(tried.mesh, level);
      std::vector<VertexId> coarse = step.coarse().vertex;
      std::sort(coarse.begin(), coarse.end());
      std::size_t next = 0;
      for (std::size_t v = 0; v < step.fine().vertex_count(); ++v) {
        const VertexId vertex = step.fine().vertex[v];
        const bool known = next < step.details().size() && step.details()[next].vertex == static_cast<int>(v);
        next += known;
        // What a coarse mesh has because its leaves are closed is new all the same where these are refined.
        const bool birth = tried.mesh.birth_level(vertex) >= level && !(std::binary_search(coarse.begin(), coarse.end(), vertex) && !known);
        EXPECT_EQ(known, birth) << level << " " << v;
      }
      EXPECT_EQ(next, step.details().size());
    }
  }
}

TEST(WaveletStep, WithoutDetailsItIsSubdivision) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    std::mt19937 random(3);
    int compared = 0;
    for (int level = 1; level <= tried.mesh.depth(); ++level) {
      const WaveletStep step(tried.mesh, level);
      const QuadMesh coarse = randomly_placed(step.coarse(), random);
      const std::vector<Vec3> fine = step.synthesise(without_details(step, coarse.points));
      SubdivisionOptions options;
      options.last = LevelKind::M;
      for (std::size_t f = 0; f < coarse.face_count(); ++f)
        for (int i = 0; i < 4; ++i)
          if (tried.mesh.is_sharp(coarse.node[f], i) && tried.mesh.level(coarse.node[f]) == level - 1)
            options.rules.creases.push_back({tried.mesh.corner(coarse.node[f], i), tried.mesh.corner(coarse.node[f], (i + 1) % 4)});
      const QuadMesh expected = subdivided(tried.mesh, coarse, level - 1, level, options).mesh;
      PointMap points;
      for (std::size_t v = 0; v < expected.vertex_count(); ++v) points[expected.vertex[v]] = expected.points[v];
      for (const int node : active_nodes(tried.mesh, level))
        for (int i = 0; i < 4; ++i) {
          const auto v = std::find(step.fine().vertex.begin(), step.fine().vertex.end(), tried.mesh.corner(node, i)) - step.fine().vertex.begin();
          EXPECT_LT((fine[v] - points.at(tried.mesh.corner(node, i))).norm(), kRounding);
          ++compared;
        }
    }
    EXPECT_GT(compared, 0);
  }
}

TEST(WaveletStep, WhatSubdivisionMakesHasNoDetails) {
  for (const HybridMesh& base : {torus(4, 3), grid(3, 2)}) {
    HybridMesh mesh = refined_at_random(base, 4, 60);
    std::mt19937 random(3);
    for (int level = 1; level <= mesh.depth(); ++level) {
      const WaveletStep step(mesh, level);
      // Vertices of closed leaves are for show where these are refined: analysis puts them back in their places.
      const std::vector<Vec3> coarse = step.analyse(randomly_placed(step.fine(), random).points).coarse;
      const LevelAnalysis analysis = step.analyse(step.synthesise(without_details(step, coarse)));
      EXPECT_LT(farthest(analysis.coarse, coarse), 1e-11);
      for (const Vec3& detail : analysis.details) EXPECT_LT(detail.norm(), 1e-11);
    }
  }
}

TEST(WaveletStep, FiltersOfSplinesAreOrthogonal) {
  HybridMesh mesh = torus(4, 4);
  mesh.refine_uniform(2);
  for (int level = 1; level <= 2; ++level) {
    const QuadMesh coarse = mesh.level_mesh(level - 1), fine = mesh.level_mesh(level);
    const LevelStep step(mesh, coarse, fine, level, BoundaryRule::EdgesOnly);
    const Eigen::MatrixXd low = subdivision_matrix(step.prediction()), high = wavelet_matrix(step);
    EXPECT_LT((low.transpose() * high).cwiseAbs().maxCoeff(), 1e-15);
    // Of one length, roughly: of two numbers of one size none is drowned by the other.
    EXPECT_NEAR(high.rightCols(high.cols() - step.prediction().rows().corners()).colwise().norm().maxCoeff(), low.colwise().norm().maxCoeff(), 0.1);
  }
}

TEST(WaveletStep, AMotionOfAllTurnsTheDetails) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Vec3(1, -2, 3).normalized()).toRotationMatrix() * 1.5;
  const Vec3 shift(3, -1, 2);
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    std::mt19937 random(5);
    const int level = tried.mesh.depth();
    const WaveletStep step(tried.mesh, level);
    const QuadMesh mesh = randomly_placed(step.fine(), random);
    const LevelAnalysis expected = transformed(step.analyse(mesh.points), turn, shift);
    const LevelAnalysis analysis = step.analyse(transformed(mesh, turn, shift).points);
    EXPECT_LT(farthest(analysis.coarse, expected.coarse), 1e-11);
    EXPECT_LT(farthest(analysis.details, expected.details), 1e-11);
  }
}

TEST(WaveletStep, SynthesisIsLocal) {
  HybridMesh mesh = torus(4, 4);
  mesh.refine_uniform(3);
  const WaveletStep step(mesh, 3);
  std::mt19937 random(9);
  LevelAnalysis analysis = step.analyse(randomly_placed(step.fine(), random).points);
  const std::vector<Vec3> before = step.synthesise(analysis);
  for (const std::size_t detail : {std::size_t{0}, step.details().size() / 2}) {
    LevelAnalysis changed = analysis;
    changed.details[detail] += Vec3(1, 1, 1);
    const std::vector<Vec3> after = step.synthesise(changed);
    std::size_t moved = 0;
    for (std::size_t v = 0; v < before.size(); ++v) moved += before[v] != after[v];
    EXPECT_EQ(moved, 25U);
  }
}

TEST(WaveletStep, OperationsVerticesAreStoredRelativeToTheirBoundary) {
  HybridMesh mesh = with_operations(torus(3, 3));
  const WaveletStep step(mesh, 2);
  std::mt19937 random(2);
  LevelAnalysis analysis = step.analyse(randomly_placed(step.fine(), random).points);
  std::size_t inserted = 0;
  for (std::size_t d = 0; d < step.details().size(); ++d) {
    if (step.details()[d].kind != DetailKind::Inserted) continue;
    ++inserted;
    EXPECT_GT(analysis.details[d].norm(), 0);
    analysis.details[d].setZero();
  }
  EXPECT_EQ(inserted, 8U);
  // Without it they are the means of their neighbours: between the corners of the quad that the cube stands on.
  const std::vector<Vec3> flat = step.synthesise(analysis);
  const HybridMesh::Operation& cube = mesh.operation(1);
  Vec3 below = Vec3::Zero(), above = Vec3::Zero();
  for (int i = 0; i < 4; ++i) {
    const auto at = [&](VertexId id) {
      return flat[std::find(step.fine().vertex.begin(), step.fine().vertex.end(), id) - step.fine().vertex.begin()];
    };
    below += at(cube.repatch.boundary[i]);
    above += at(VertexId(VertexId::Kind::Free, cube.first_vertex + i));
  }
  EXPECT_LT((below - above).norm(), kRounding);
}

TEST(WaveletStep, OnlyACubeLeavesARemainder) {
  HybridMesh mesh = cube();
  mesh.refine_uniform(2);
  std::mt19937 random(2);
  for (int level = 1; level <= 2; ++level) {
    const WaveletStep step(mesh, level);
    EXPECT_EQ(step.analyse(randomly_placed(step.fine(), random).points).remainder.empty(), level == 2);
  }
}

TEST(WaveletStep, WrongNumbersAreRefused) {
  HybridMesh mesh = torus(3, 3);
  mesh.refine_uniform(2);
  EXPECT_THROW(WaveletStep(mesh, 0), Error);
  EXPECT_THROW(WaveletStep(mesh, 3), Error);
  const WaveletStep step(mesh, 2);
  std::vector<Vec3> points(step.fine().vertex_count(), Vec3::Zero());
  EXPECT_NO_THROW(step.analyse(points));
  LevelAnalysis analysis = step.analyse(points);
  analysis.details.pop_back();
  EXPECT_THROW(step.synthesise(analysis), Error);
  points.back().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(step.analyse(points), Error);
  points.pop_back();
  EXPECT_THROW(step.analyse(points), Error);
}

}  // namespace
}  // namespace hybrid_mesh
