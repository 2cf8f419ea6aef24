// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/level_step.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "decoder/planes/coefficient_layout.h"
#include "hierarchy/flat_points.h"
#include "wavelets/hierarchies.h"

namespace hybrid_mesh {
namespace {

// The rules are OpenSubdiv's.
TEST(SubdivisionMasks, AreThoseOfCatmullClark) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    if (!tried.mesh.conforming() || tried.mesh.operation_count() > 0 || tried.mesh.has_sharp_sides()) continue;
    for (const BoundaryRule boundary : {BoundaryRule::EdgesOnly, BoundaryRule::EdgesAndCorners}) {
      std::mt19937 random(3);
      const HybridMesh& mesh = tried.mesh;
      const QuadMesh coarse = randomly_placed(mesh.level_mesh(1), random), fine = mesh.level_mesh(2);
      SubdivisionOptions options;
      options.rules.boundary = boundary;
      const SubdividedMesh expected = subdivided(mesh, coarse, 1, 2, options);
      const LevelPrediction prediction(mesh, coarse, fine, 2, boundary);
      std::vector<Point3> points(prediction.count());
      prediction.regular(flat_points(coarse.points).data(), points.data());
      ASSERT_EQ(expected.mesh.vertex, fine.vertex);
      EXPECT_LT(farthest(vectors_of(points), expected.mesh.points), 1e-14);
    }
  }
}

// Points by stencils of their own are those that masks give, bit by bit.
TEST(SubdivisionMasks, PointsAreSumsOfMasks) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    std::mt19937 random(3);
    for (int level = 1; level <= tried.mesh.depth(); ++level) {
      const QuadMesh coarse = randomly_placed(tried.mesh.level_mesh(level - 1), random), fine = tried.mesh.level_mesh(level);
      const LevelPrediction prediction(tried.mesh, coarse, fine, level, BoundaryRule::EdgesOnly);
      const std::vector<Point3> given = flat_points(coarse.points);
      std::vector<Point3> points(prediction.count());
      prediction.regular(given.data(), points.data());
      SubdivisionMasks masks(prediction.quads(), given.size(), BoundaryRule::EdgesOnly);
      const RefinedRows& rows = prediction.rows();
      for (int row = 0; row < rows.size(); ++row) {
        const int of = rows.source(row), v = prediction.vertex_at[row];
        if (v < 0) continue;
        Point3 sum;
        for (const auto& [vertex, weight] : rows.is_corner(row)     ? masks.vertex_mask(of)
                                            : rows.is_midpoint(row) ? masks.edge_mask(of)
                                                                    : masks.quad_mask(of))
          sum += weight * given[vertex];
        ASSERT_TRUE(sum.x == points[v].x && sum.y == points[v].y && sum.z == points[v].z) << row;
      }
    }
  }
}

// The short cut for regular surroundings gives what the definition gives.
TEST(WaveletColumns, RegularOnesAreNoOthers) {
  int regular = 0;
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    HybridMesh mesh = tried.mesh;
    if (mesh.conforming() && mesh.operation_count() == 0) mesh.refine_uniform(4);
    for (int level = 1; level <= mesh.depth(); ++level) {
      const LevelStep step(mesh, mesh.level_mesh(level - 1), mesh.level_mesh(level), level, BoundaryRule::EdgesOnly);
      const RefinedRows& rows = step.prediction().rows();
      WaveletColumns columns = step.columns(), defined(rows, std::vector<char>(step.inside().size(), 0));
      for (int column = rows.corners(); column < rows.size(); ++column) {
        std::map<int, double> a, b;
        columns.for_entries(column, [&](int row, double value) { EXPECT_TRUE(a.emplace(row, value).second); });
        defined.for_entries(column, [&](int row, double value) { EXPECT_TRUE(b.emplace(row, value).second); });
        ASSERT_EQ(a, b) << level << " " << column;
      }
      for (const char inside : step.inside()) regular += inside;
    }
  }
  EXPECT_GT(regular, 1000);
}

// What FORMAT.md calls near: weights of items one edge away, and two edges away.
TEST(CoefficientLayout, NeighboursAreThoseOfTheFaces) {
  for (const Hierarchy& tried : hierarchies()) {
    SCOPED_TRACE(tried.name);
    HybridMesh mesh = tried.mesh;
    if (mesh.conforming() && mesh.operation_count() == 0) mesh.refine_uniform(4);
    for (int level = 1; level <= mesh.depth(); ++level) {
      const QuadMesh coarse = mesh.level_mesh(level - 1);
      const LevelMesh fine = mesh.connectivity(level, LevelKind::N, mesh.closure());
      const LevelStep step(mesh, coarse, fine, level, BoundaryRule::EdgesOnly);
      const CoefficientLayout layout = coefficient_layout(mesh, step, coarse, fine, false);
      std::vector<std::set<int>> star(fine.vertex_count());
      for (std::size_t f = 0; f < fine.face_count(); ++f)
        for (auto c = fine.offsets[f]; c < fine.offsets[f + 1]; ++c) {
          const int a = fine.indices[c], b = fine.indices[c + 1 < fine.offsets[f + 1] ? c + 1 : fine.offsets[f]];
          if (a != b) star[a].insert(b), star[b].insert(a);
        }
      std::vector<int> item_at(fine.vertex_count(), -1);
      for (std::size_t i = 0; i < layout.items.size(); ++i) item_at[layout.items[i].vertex] = static_cast<int>(i);
      for (std::size_t i = 0; i < layout.items.size(); ++i) {
        const int vertex = layout.items[i].vertex;
        std::map<int, int> ways, expected, found;
        for (const int v : star[vertex])
          for (const int w : star[v]) ++ways[w];
        for (const auto& [w, count] : ways)
          if (w != vertex && item_at[w] >= 0) expected[item_at[w]] = count == 1 ? 2 : 1;
        for (const int v : star[vertex])
          if (item_at[v] >= 0) expected[item_at[v]] = 2;
        std::uint32_t weight = 0;
        for (auto k = layout.first_neighbour[i]; k < layout.first_neighbour[i + 1]; ++k) {
          EXPECT_TRUE(found.emplace(layout.neighbours[k].item, 1 + layout.neighbours[k].twice).second);
          weight += 1 + layout.neighbours[k].twice;
        }
        ASSERT_EQ(found, expected) << level << " " << i;
        ASSERT_EQ(layout.weight[i], weight);
      }
    }
  }
}

}  // namespace
}  // namespace hybrid_mesh
