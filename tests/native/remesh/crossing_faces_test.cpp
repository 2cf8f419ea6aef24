// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/crossing_faces.h"

#include <gtest/gtest.h>

#include <cmath>

#include "remesh/quality.h"
#include "remesh/sheets.h"

namespace hybrid_mesh {
namespace {

using testing::kMiddle;
using testing::kSide;
using testing::two_sheets;

TakenBack taken_back(QuadMesh& mesh, const std::vector<Vec3>& before) {
  Context context;
  return take_back_crossings(mesh, before, {}, Progress(context));
}

std::size_t crossing(const QuadMesh& mesh) {
  Context context;
  return crossing_faces(mesh, Progress(context)).size();
}

TEST(CrossingFaces, AreTakenApartWhereTheyCrossAndNowhereElse) {
  const QuadMesh before = two_sheets(1, 0), after = two_sheets(1, 1.6);
  ASSERT_EQ(crossing(before), 0U);
  ASSERT_GT(crossing(after), 10U);
  QuadMesh mesh = after;
  const TakenBack taken = taken_back(mesh, before.points);
  EXPECT_TRUE(taken.any);
  EXPECT_EQ(taken.left, 0U);
  EXPECT_EQ(crossing(mesh), 0U);
  double highest = 0;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    if (v < mesh.points.size() / 2) highest = std::max(highest, mesh.points[v].z());
    // Only part of the way back, on the way that each vertex came.
    EXPECT_LE(mesh.points[v].z(), after.points[v].z() + 1e-15);
    EXPECT_GE(mesh.points[v].z(), before.points[v].z() - 1e-15);
    const double off = std::hypot(after.points[v].x() - kMiddle, after.points[v].y() - kMiddle);
    if (off > 7) {
      EXPECT_EQ(mesh.points[v], after.points[v]);
    }
  }
  EXPECT_GT(highest, 0.4);  // the bulge is lower, not gone
}

TEST(CrossingFaces, NothingIsChangedWhereNothingCrosses) {
  const QuadMesh before = two_sheets(1, 0), after = two_sheets(1, 0.9);
  QuadMesh mesh = after;
  const TakenBack taken = taken_back(mesh, before.points);
  EXPECT_FALSE(taken.any);
  EXPECT_EQ(mesh.points, after.points);
}

TEST(CrossingFaces, WhatCrossedBeforeGetsNoWorse) {
  const QuadMesh before = two_sheets(1, 1.3), after = two_sheets(1, 1.9);
  QuadMesh mesh = after;
  const TakenBack taken = taken_back(mesh, before.points);
  EXPECT_TRUE(taken.any);
  EXPECT_GT(taken.left, 0U);
  EXPECT_GT(crossing(mesh), 0U);
  EXPECT_LE(crossing(mesh), crossing(before));
}

TEST(CrossingFaces, AreNotTakenApartAtAnyPrice) {
  // The way back turns squares over, so that more would be inverted than cross.
  QuadMesh before = two_sheets(1, 0), mesh = two_sheets(1, 1.6);
  for (std::size_t v = 0; v < before.points.size() / 2; ++v) {
    const int i = static_cast<int>(v) % (kSide + 1);
    before.points[v].x() = i + (i % 2 == 0 ? 1.4 : -1.4);
  }
  const std::size_t crossed = crossing(mesh);
  const TakenBack taken = taken_back(mesh, before.points);
  EXPECT_TRUE(taken.any);
  EXPECT_LE(quad_quality(mesh).inverted * 2 * kSide * kSide, 4.0 * static_cast<double>(crossed));
}

}  // namespace
}  // namespace hybrid_mesh
