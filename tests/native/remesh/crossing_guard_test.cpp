// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/crossing_guard.h"

#include <gtest/gtest.h>

#include <vector>

#include "remesh/angle_relaxation.h"
#include "remesh/crossing_faces.h"
#include "remesh/quality.h"
#include "remesh/sheets.h"

namespace hybrid_mesh {
namespace {

using testing::kMiddle;
using testing::kSide;
using testing::two_sheets;

// The vertex in the middle of the lower sheet.
constexpr int kCentre = kMiddle * (kSide + 1) + kMiddle;

std::size_t crossing(const QuadMesh& mesh) {
  Context context;
  return crossing_faces(mesh, Progress(context)).size();
}

TEST(CrossingGuard, CountsThePairsOfFacesAtAVertex) {
  QuadMesh mesh = two_sheets(1, 0);
  const CrossingGuard guard(mesh);
  const Vec3 home = mesh.points[kCentre];
  EXPECT_EQ(guard.crossings(kCentre, home), 0);
  EXPECT_TRUE(guard.allows(kCentre, home + Vec3(0, 0, 0.9)));
  const Vec3 through = home + Vec3(0, 0, 1.5);
  EXPECT_FALSE(guard.allows(kCentre, through));
  const int counted = guard.crossings(kCentre, through);
  mesh.points[kCentre] = through;
  EXPECT_EQ(static_cast<std::size_t>(counted), crossing(mesh));
}

TEST(CrossingGuard, SeesWhereOthersHaveGone) {
  QuadMesh mesh = two_sheets(1, 0);
  CrossingGuard guard(mesh);
  const Vec3 up(0, 0, 0.9);
  EXPECT_TRUE(guard.allows(kCentre, mesh.points[kCentre] + up));
  // The upper sheet comes down there, far beyond the boxes that its faces had at the start.
  const int above = static_cast<int>(mesh.points.size()) / 2 + kCentre;
  mesh.points[above] -= 0.8 * Vec3::UnitZ();
  guard.moved(above);
  EXPECT_FALSE(guard.allows(kCentre, mesh.points[kCentre] + up));
  EXPECT_TRUE(guard.allows(kCentre, mesh.points[kCentre] + 0.1 * up));
}

TEST(CrossingGuard, FacesArePartedWithoutFoldingAny) {
  QuadMesh mesh = two_sheets(1, 0);
  const std::vector<Vec3> before = mesh.points;
  for (const int v : {kCentre, kCentre + 3, kCentre + 4}) mesh.points[v].z() = 1.4;
  ASSERT_GT(crossing(mesh), 4U);
  const std::vector<Vec3> after = mesh.points;
  CrossingGuard guard(mesh);
  Context context;
  separate_faces(mesh, std::vector<char>(mesh.points.size(), 0), before, {}, guard, Progress(context));
  EXPECT_EQ(crossing(mesh), 0U);
  EXPECT_TRUE(inverted_quads(mesh).empty());
  // What does not take part stays where it is.
  for (std::size_t v = 0; v < mesh.points.size(); ++v)
    if ((after[v] - after[kCentre]).head<2>().norm() > 6) {
      EXPECT_EQ(mesh.points[v], after[v]);
    }
}

TEST(CrossingGuard, WhatIsRightAsItIsStays) {
  QuadMesh mesh = two_sheets(1, 0);
  const std::vector<Vec3> before = mesh.points;
  mesh.points[kCentre].z() = 1.4;
  const std::vector<Vec3> after = mesh.points;
  CrossingGuard guard(mesh);
  Context context;
  const CrossingFilter all_right = [](const QuadMesh&, CrossingFaces& pairs) { pairs.clear(); };
  separate_faces(mesh, std::vector<char>(mesh.points.size(), 0), before, all_right, guard, Progress(context));
  EXPECT_EQ(mesh.points, after);
  EXPECT_FALSE(take_back_crossings(mesh, before, all_right, Progress(context)).any);
  EXPECT_EQ(mesh.points, after);
}

TEST(CrossingGuard, FixedVerticesStay) {
  QuadMesh mesh = two_sheets(1, 0);
  const std::vector<Vec3> before = mesh.points;
  mesh.points[kCentre].z() = 1.4;
  const std::vector<Vec3> after = mesh.points;
  CrossingGuard guard(mesh);
  Context context;
  separate_faces(mesh, std::vector<char>(mesh.points.size(), 1), before, {}, guard, Progress(context));
  EXPECT_EQ(mesh.points, after);
}

// A quad of the lower sheet that is folded right below the upper one, whose middle reaches down beside it.
TEST(CrossingGuard, QuadsAreUnfoldedOnlyWhereNoMoreFacesCross) {
  for (const bool guarded : {false, true}) {
    QuadMesh mesh = two_sheets(0.02, 0);
    const int above = static_cast<int>(mesh.points.size()) / 2 + kCentre;
    mesh.points[above].z() = -3;
    mesh.points[kCentre] += Vec3(1.3, 0.9, 0);
    const std::size_t crossed = crossing(mesh), inverted = inverted_quads(mesh).size();
    ASSERT_GT(crossed, 0U);
    ASSERT_GT(inverted, 0U);
    AngleRelaxationOptions options;
    options.enough = 0.05;
    options.flatness = -1;
    CrossingGuard guard(mesh);
    Context context;
    relax_angles(mesh, std::vector<char>(mesh.points.size(), 0), options, Progress(context), guarded ? &guard : nullptr);
    if (guarded) {
      EXPECT_LE(crossing(mesh), crossed);
    }
    EXPECT_LE(inverted_quads(mesh).size(), inverted);
  }
}

}  // namespace
}  // namespace hybrid_mesh
