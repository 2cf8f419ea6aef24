// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/crossing_guard.h"

#include <gtest/gtest.h>

#include <vector>

#include "remesh/angle_relaxation.h"
#include "remesh/crossing_faces.h"
#include "remesh/face_separation.h"
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

// Vertices of the lower sheet go through the upper one.
class FaceSeparation : public ::testing::Test {
 protected:
  FaceSeparation() : mesh_(two_sheets(1, 0)), before_(mesh_.points) {
    for (const int v : {kCentre, kCentre + 3, kCentre + 4}) mesh_.points[v].z() = 1.4;
    after_ = mesh_.points;
  }
  void separate(char fixed, const CrossingFilter& filter) {
    CrossingGuard guard(mesh_);
    Context context;
    separate_faces(mesh_, std::vector<char>(mesh_.points.size(), fixed), before_, filter, guard, Progress(context));
  }

  QuadMesh mesh_;
  const std::vector<Vec3> before_;
  std::vector<Vec3> after_;
};

TEST_F(FaceSeparation, PartsFacesWithoutFoldingAny) {
  ASSERT_GT(crossing(mesh_), 4U);
  separate(0, {});
  EXPECT_EQ(crossing(mesh_), 0U);
  EXPECT_TRUE(inverted_quads(mesh_).empty());
  // What does not take part stays where it is.
  for (std::size_t v = 0; v < mesh_.points.size(); ++v)
    if ((after_[v] - after_[kCentre]).head<2>().norm() > 6) {
      EXPECT_EQ(mesh_.points[v], after_[v]);
    }
}

TEST_F(FaceSeparation, LeavesWhatIsRightAsItIs) {
  const CrossingFilter all_right = [](const QuadMesh&, CrossingFaces& pairs) { pairs.clear(); };
  separate(0, all_right);
  EXPECT_EQ(mesh_.points, after_);
  Context context;
  EXPECT_FALSE(take_back_crossings(mesh_, before_, all_right, Progress(context)).any);
  EXPECT_EQ(mesh_.points, after_);
}

TEST_F(FaceSeparation, LeavesFixedVertices) {
  separate(1, {});
  EXPECT_EQ(mesh_.points, after_);
}

// The corner of the lower sheet is turned in, over its quad; where it belongs the corner of the upper one has come down.
TEST(CrossingGuard, QuadsAreUnfoldedOnlyWhereNoMoreFacesCross) {
  QuadMesh folded = two_sheets(1, 0);
  folded.points[0] = Vec3(1.3, 1.3, 0.1);
  folded.points[folded.points.size() / 2] = Vec3(0.15, 0.15, -0.2);
  ASSERT_EQ(crossing(folded), 0U);
  ASSERT_EQ(inverted_quads(folded).size(), 1U);
  AngleRelaxationOptions options;
  options.flatness = -1;
  for (const bool guarded : {false, true}) {
    QuadMesh mesh = folded;
    CrossingGuard guard(mesh);
    Context context;
    relax_angles(mesh, std::vector<char>(mesh.points.size(), 0), options, Progress(context), guarded ? &guard : nullptr);
    EXPECT_EQ(crossing(mesh) == 0, guarded);
    EXPECT_NE(mesh.points[0], folded.points[0]);  // as far as it may
  }
}

}  // namespace
}  // namespace hybrid_mesh
