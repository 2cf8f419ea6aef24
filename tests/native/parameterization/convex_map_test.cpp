// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/convex_map.h"

#include <gtest/gtest.h>

namespace hybrid_mesh {
namespace {

// A strip of 3 x `rows` squares, each two triangles, none of which joins two points of the long way around.
struct Finger {
  TriangleSurface mesh;
  std::vector<int> faces;
  std::vector<DiskSide> sides;  // the three squares' ends at the bottom; up, across the top and down again
};

Finger finger(int rows) {
  Finger f;
  const auto at = [](int x, int y) { return 4 * y + x; };
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x < 4; ++x) f.mesh.points.push_back(Vec3(x, y, 0));
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < 3; ++x) {
      const int a = at(x, y), b = at(x + 1, y), c = at(x + 1, y + 1), d = at(x, y + 1);
      if (x == 0)
        f.mesh.faces.insert(f.mesh.faces.end(), {{a, b, d}, {b, c, d}});
      else
        f.mesh.faces.insert(f.mesh.faces.end(), {{a, b, c}, {a, c, d}});
    }
  for (std::size_t i = 0; i < f.mesh.faces.size(); ++i) {
    f.faces.push_back(static_cast<int>(i));
    f.mesh.source_face.push_back(static_cast<int>(i));
  }
  connect_half_edges(f.mesh);
  for (int x = 0; x < 3; ++x) f.sides.push_back({{at(x, 0), at(x + 1, 0)}, {}});
  DiskSide around;
  for (int y = 0; y <= rows; ++y) around.points.push_back(at(3, y));
  for (int x = 2; x > 0; --x) around.points.push_back(at(x, rows));
  for (int y = rows; y >= 0; --y) around.points.push_back(at(0, y));
  f.sides.push_back(around);
  return f;
}

// Between the two flanks of one side a convex combination squeezes every row to a fraction of the one below.
TEST(ConvexMap, HoldsInAFingerBetweenTwoPartsOfOneSide) {
  for (const int rows : {5, 40, 120}) {
    const Finger f = finger(rows);
    ConvexMap map(f.mesh);
    ASSERT_TRUE(map.side_chords(f.faces, f.sides).empty());
    std::vector<std::array<Vec2, 3>> corners(f.faces.size());
    ASSERT_TRUE(map(f.faces, f.sides, {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}, corners)) << rows;
    for (const auto& uv : corners) {
      const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
      EXPECT_GT(a.x() * b.y() - a.y() * b.x(), 0);
      for (const Vec2& p : uv) EXPECT_TRUE(p.minCoeff() >= 0 && p.maxCoeff() <= 1);
    }
    // The long way around lies on the square's left side, x = 0.
    for (const int face : f.faces)
      for (int k = 0; k < 3; ++k)
        if (const int v = f.mesh.faces[face][k]; v % 4 == 0 || (v > 3 && v % 4 == 3) || v >= 4 * rows) {
          EXPECT_EQ(corners[face][k].x(), 0);
        }
  }
}

}  // namespace
}  // namespace hybrid_mesh
