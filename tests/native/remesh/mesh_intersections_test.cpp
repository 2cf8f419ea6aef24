// SPDX-License-Identifier: GPL-3.0-or-later
#include "remesh/mesh_intersections.h"

#include <gtest/gtest.h>

#include "generated_surfaces.h"
#include "remesh/meshes.h"
#include "shapes.h"

namespace hybrid_mesh {
namespace {

using testing::mesh_of;
using testing::repaired;

// Two sheets of squares; the second one stands across the first one, along a line of it.
PolygonSoup crossing_sheets(double shift = 0) {
  PolygonSoup soup;
  for (int sheet = 0; sheet < 2; ++sheet) {
    const auto first = static_cast<std::int32_t>(soup.points.size());
    for (int j = 0; j <= 4; ++j)
      for (int i = 0; i <= 4; ++i) soup.points.push_back(sheet == 0 ? Vec3(i, j, 0) : Vec3(1.3 + shift, j + 0.4, i - 1.7));
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) {
        const int a = first + 5 * j + i;
        for (const int v : {a, a + 1, a + 6, a + 5}) soup.indices.push_back(v);
        soup.offsets.push_back(static_cast<std::int64_t>(soup.indices.size()));
      }
  }
  return soup;
}

MeshIntersections found(const QuadMesh& mesh, const PolygonSoup& input, const Placement& placement = {}) {
  Context context;
  const TriangleSurface surface = repaired(input);
  const MeshIntersections m = mesh_intersections(mesh, {&surface, placement}, Progress(context));
  EXPECT_EQ(context.progress(), 1);
  return m;
}

PolygonSoup sheets_apart() {
  PolygonSoup soup = crossing_sheets();
  for (std::size_t i = 25; i < soup.points.size(); ++i) soup.points[i].x() += 20;
  return soup;
}

TEST(MeshIntersections, ArePairsOfFacesWithAPlace) {
  const MeshIntersections m = found(mesh_of(crossing_sheets()), sheets_apart());
  // The line x = 1.3, z = 0 goes through four squares of the first sheet and four of the second, whose edges it crosses in turn.
  EXPECT_EQ(m.pairs, 7);
  EXPECT_EQ(m.pairs_of_input, 0);
  ASSERT_TRUE(m.where);
  EXPECT_NEAR(m.where->x(), 1.3, 1e-9);
  EXPECT_NEAR(m.where->z(), 0, 1e-9);
}

TEST(MeshIntersections, DoNotCountWhereTheInputHasThem) {
  const Placement placement{Vec3(2, -7, 3), 6};
  const MeshIntersections same = found(mesh_of(crossing_sheets(), placement), crossing_sheets(), placement);
  EXPECT_EQ(same.pairs, 0);
  EXPECT_EQ(same.pairs_of_input, 7);
  EXPECT_FALSE(same.where);
  // Somewhat beside it is there, two squares on it is not.
  EXPECT_EQ(found(mesh_of(crossing_sheets(0.3), placement), crossing_sheets(), placement).pairs, 0);
  EXPECT_EQ(found(mesh_of(crossing_sheets(2), placement), crossing_sheets(), placement).pairs, 7);
}

// Two large squares lie on each other: what a mesh of them does anywhere on them is no fault of its own.
TEST(MeshIntersections, DoNotCountOnAWallOfTwoSheets) {
  PolygonSoup sheets = soup_of({{-5, -5, 0}, {9, -5, 0}, {9, 9, 0}, {-5, 9, 0}}, {{0, 1, 2, 3}}), other = sheets;
  std::swap(other.indices[1], other.indices[3]);
  for (Vec3& p : other.points) p += Vec3(0.5, 0.25, 0);
  append(sheets, other);
  const MeshIntersections m = found(mesh_of(crossing_sheets()), sheets);
  EXPECT_EQ(m.pairs, 0);
  EXPECT_EQ(m.pairs_of_input, 7);
}

// A flat surface of two sides, whose mesh is as flat: all of it lies on itself, wherever it stands.
TEST(MeshIntersections, DoNotCountOnAFlatPillow) {
  const PolygonSoup pillow = soup_of({{0.1, 0, 0}, {0.1, 3, 0}, {0.1, 3, 3}, {0.1, 0, 3}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
  PolygonSoup fine;
  for (int side = 0; side < 2; ++side) {
    PolygonSoup squares = grid(6, 6);
    for (Vec3& p : squares.points) p = Vec3(0.1, p.x() / 2, p.y() / 2);
    append(fine, squares);
  }
  const Placement placement{Vec3(0.7, 0.3, -1.1), 4.3};
  const MeshIntersections m = found(mesh_of(fine, placement), pillow, placement);
  EXPECT_EQ(m.pairs, 0);
  EXPECT_GE(m.pairs_of_input, 72);
}

TEST(MeshIntersections, AreNoneOfSoundMeshes) {
  for (const PolygonSoup& soup : {testing::torus(30, 20), cube()}) {
    const MeshIntersections m = found(mesh_of(soup), soup);
    EXPECT_EQ(m.pairs + m.pairs_of_input, 0);
  }
}

TEST(MeshIntersections, AFoldedQuadIsNone) {
  PolygonSoup soup = soup_of({{0, 0, 0}, {2, 0, 0}, {0.2, 0.2, 0}, {0, 2, 0}}, {{0, 1, 2, 3}});
  EXPECT_EQ(found(mesh_of(soup), soup).pairs, 0);
}

}  // namespace
}  // namespace hybrid_mesh
