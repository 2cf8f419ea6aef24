// SPDX-License-Identifier: GPL-3.0-or-later
#include "decoder/transform/plain_levels.h"

#include <gtest/gtest.h>

#include "decoder/transform/level_prediction.h"
#include "hierarchy/bases.h"

namespace hybrid_mesh {
namespace {

void expect_same(const LevelMesh& a, const LevelMesh& b) {
  EXPECT_EQ(a.offsets, b.offsets);
  EXPECT_EQ(a.indices, b.indices);
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.vertex, b.vertex);
  EXPECT_EQ(a.sharp, b.sharp);
  EXPECT_TRUE(a.conforming && b.conforming);
}

void expect_same(const LevelQuads& a, const LevelQuads& b) {
  EXPECT_EQ(a.node, b.node);
  EXPECT_EQ(a.vertex, b.vertex);
  EXPECT_EQ(a.half, b.half);
  EXPECT_EQ(a.across, b.across);
  EXPECT_EQ(a.edge, b.edge);
  EXPECT_EQ(a.side, b.side);
  EXPECT_EQ(a.sharp, b.sharp);
  EXPECT_EQ(a.in_mesh, b.in_mesh);
  EXPECT_EQ(a.start, b.start);
  EXPECT_EQ(a.valence, b.valence);
  EXPECT_EQ(a.creases, b.creases);
}

// Number by number what a forest has that grows from the same base.
TEST(PlainLevels, AreThoseOfTheForest) {
  constexpr int depth = 3;
  for (Base& base : bases())
    for (const bool sharp : {false, true}) {
      SCOPED_TRACE(base.name);
      if (sharp) base.mesh.set_sharp(0, 1);
      HybridMesh forest = base.mesh;
      forest.refine_uniform(depth);
      const auto level_mesh = [&](int level) { return forest.connectivity(level, LevelKind::N, FaceClosure::Quads); };
      PlainLevels levels(base.mesh, base.mesh.connectivity(0, LevelKind::N, FaceClosure::Quads));
      for (int j = 0; j < depth; ++j) {
        const LevelMesh coarse = level_mesh(j), fine = level_mesh(j + 1);
        const PlainLevels::Step step = levels.refine(j + 1 == depth);
        expect_same(step.mesh, coarse);
        expect_same(levels.mesh(), fine);
        const LevelPrediction prediction(forest, coarse, fine, j + 1, BoundaryRule::EdgesOnly);
        expect_same(step.quads, prediction.quads());
        EXPECT_EQ(step.rows, prediction.vertex_at);
        EXPECT_TRUE(prediction.stays.empty() && prediction.closing.empty() && prediction.inserted.empty());
      }
    }
}

}  // namespace
}  // namespace hybrid_mesh
