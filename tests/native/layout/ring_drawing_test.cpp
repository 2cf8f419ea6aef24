// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/regions/ring_drawing.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "layout/regions/region_pattern.h"
#include "surface/edit_mesh.h"

namespace hybrid_mesh {
namespace {

// A tube of `around` triangles' edges and `rows` rows of triangles, whose first boundary is the region's rim with `sides` sides; the second one is a
// rim as well (`other` sides), or open (0).
struct Tube {
  RegionSurface surface;
  PatchRegion region;
};

Tube tube(int around, int rows, int sides, int other) {
  Tube out;
  TriangleSurface& mesh = out.surface.mesh;
  for (int r = 0; r <= rows; ++r)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.37 * r) / around, wide = 1 + 0.2 * std::sin(3.0 * r / rows);
      mesh.points.push_back({wide * std::cos(angle), wide * std::sin(angle), 3.0 * r / rows});
    }
  const auto at = [&](int i, int r) { return r * around + i % around; };
  for (int r = 0; r < rows; ++r)
    for (int i = 0; i < around; ++i) {
      mesh.faces.push_back({at(i, r), at(i + 1, r), at(i, r + 1)});
      mesh.faces.push_back({at(i + 1, r), at(i + 1, r + 1), at(i, r + 1)});
    }
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) mesh.source_face.push_back(static_cast<int>(f));
  connect_half_edges(mesh);
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    out.surface.source.push_back({{static_cast<int>(v), -1, -1}, {1, 0, 0}});
    out.surface.point.push_back(static_cast<int>(v));
  }
  // With the surface on the left the first boundary runs with the triangles, the second against them.
  const auto add_sides = [&](int count, int row, bool back) {
    for (int k = 0; k < count; ++k) {
      std::vector<int>& side = out.surface.sides.emplace_back();
      for (int i = k * around / count; i <= (k + 1) * around / count; ++i) side.push_back(at(back ? (2 * around - i) % around : i, row));
    }
  };
  add_sides(sides, 0, false);
  add_sides(other, rows, true);
  out.region.rims = {0, sides};
  out.region.pieces = {{{0}, 0, other == 0}};
  if (other > 0) {
    out.region.rims.push_back(sides + other);
    out.region.pieces[0].rims.push_back(1);
  }
  out.region.corners.resize(sides + other);
  out.region.boundary.resize(sides + other);
  return out;
}

double area_of(const TriangleSurface& mesh, const std::vector<int>* of = nullptr, int which = 0) {
  double area = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (of && (*of)[f] != which) continue;
    const auto& c = mesh.faces[f];
    area += 0.5 * (mesh.points[c[1]] - mesh.points[c[0]]).cross(mesh.points[c[2]] - mesh.points[c[0]]).norm();
  }
  return area;
}

void expect_drawn(Tube tube, const LayoutEdit& edit, const std::vector<int>& spoke) {
  const double area = area_of(tube.surface.mesh);
  const std::vector<Vec3> corners = [&] {
    std::vector<Vec3> out;
    for (std::size_t k = 0; k < tube.surface.sides.size(); ++k) out.push_back(tube.surface.mesh.points[tube.surface.corner(static_cast<int>(k))]);
    return out;
  }();
  const PatchedSurface piece = draw_ring(tube.surface, edit, spoke);
  ASSERT_EQ(piece.patch_count(), static_cast<int>(edit.quads.size()));
  EXPECT_NEAR(area_of(piece.mesh), area, 1e-9 * area);
  EXPECT_NEAR(area_of(tube.surface.mesh), area, 1e-9 * area);
  // It is a ring still, every side is one line that its two quads share, and every quad is a disk within its four.
  const EditMesh mesh(piece.mesh);
  std::map<std::pair<int, int>, std::vector<int>> lines;
  for (int q = 0; q < piece.patch_count(); ++q) {
    EXPECT_GT(area_of(piece.mesh, &piece.patch, q), 0);
    std::set<int> points, on_sides;
    int faces = 0;
    for (std::size_t f = 0; f < piece.mesh.faces.size(); ++f)
      if (piece.patch[f] == q) {
        ++faces;
        points.insert(piece.mesh.faces[f].begin(), piece.mesh.faces[f].end());
      }
    int around = 0;
    for (int i = 0; i < 4; ++i) {
      const std::vector<int>& side = piece.sides[q][i];
      around += static_cast<int>(side.size()) - 1;
      on_sides.insert(side.begin(), side.end());
      EXPECT_EQ(side.back(), piece.sides[q][(i + 1) % 4].front());
      const int a = edit.quads[q][i], b = edit.quads[q][(i + 1) % 4];
      if (a < static_cast<int>(corners.size())) {
        EXPECT_EQ(piece.mesh.points[side.front()], corners[a]);
      }
      const auto back = lines.find({b, a});
      if (back != lines.end()) {
        EXPECT_EQ(std::vector<int>(side.rbegin(), side.rend()), back->second);
        EXPECT_GE(piece.neighbours[q][i].patch, 0);
      }
      lines[{a, b}] = side;
    }
    EXPECT_EQ(static_cast<int>(on_sides.size()), around);
    // Euler: V - E + F = 1 with E = (3 F + boundary) / 2.
    EXPECT_EQ(2 * static_cast<int>(points.size()) - faces - around, 2);
  }
  std::set<int> loops;
  for (const int loop : mesh.boundary_loops())
    if (loop >= 0) loops.insert(loop);
  EXPECT_EQ(loops.size(), 2u);
}

TEST(RingDrawing, RowsBetweenTwoRims) {
  Context context;
  for (const int rows : {1, 2, 5})
    for (const int triangles : {1, 4, 9}) {
      const Tube t = tube(24, triangles, 6, 6);
      for (const int shift : {0, 2}) {
        std::vector<int> spoke;
        const LayoutEdit edit = rows_edit({}, t.region, rows, shift, spoke, Progress(context));
        EXPECT_EQ(spoke.size(), static_cast<std::size_t>(rows) + 1);
        expect_drawn(t, edit, spoke);
      }
    }
}

TEST(RingDrawing, RowsToAnOpenBoundary) {
  Context context;
  for (const int rows : {1, 3})
    for (const int around : {8, 24}) {
      const Tube t = tube(around, 4, 8, 0);
      std::vector<int> spoke;
      const LayoutEdit edit = rows_edit({}, t.region, rows, 0, spoke, Progress(context));
      expect_drawn(t, edit, spoke);
    }
}

TEST(RingDrawing, AWayAcrossIsFoundWhereNoneIsKnown) {
  Context context;
  const Tube t = tube(24, 5, 6, 6);
  std::vector<int> spoke;
  const LayoutEdit edit = rows_edit({}, t.region, 3, 1, spoke, Progress(context));
  const std::vector<int> found = find_spoke(edit.quads, 12, 6);
  EXPECT_EQ(found.size(), 4u);
  EXPECT_EQ(found.front(), 0);
  EXPECT_GE(found.back(), 6);
  EXPECT_LT(found.back(), 12);
  expect_drawn(t, edit, found);
}

}  // namespace
}  // namespace hybrid_mesh
