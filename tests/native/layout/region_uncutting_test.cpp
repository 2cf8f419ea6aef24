// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/region_uncutting.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <memory>
#include <numeric>
#include <set>

#include "hierarchy/bases.h"
#include "layout/level_state.h"

namespace hybrid_mesh {
namespace {

// Two squares side by side, mapped by triangles that know nothing of their quadrants.
LevelState two_squares(int n) {
  LevelState state;
  state.quads.nodes = {{0, 1, 2, 3}, {1, 4, 5, 2}};
  state.quads.neighbours.resize(2);
  state.quads.neighbours[0][1] = {1, 3};
  state.quads.neighbours[1][3] = {0, 1};
  state.quads.node_count = 6;
  state.area = 2;
  for (int k = 0; k < 2; ++k)
    state.maps.push_back(
        {std::make_shared<const PatchMap>(make_map(n, 0.3, n, [k](double u, double v) { return Vec3(u + k, v, 0.2 * (u + k) * (u + k) * v); })), {}});
  return state;
}

double area_of(const TriangleSurface& mesh) {
  double area = 0;
  for (const auto& f : mesh.faces) area += 0.5 * (mesh.points[f[1]] - mesh.points[f[0]]).cross(mesh.points[f[2]] - mesh.points[f[0]]).norm();
  return area;
}

struct Uncut {
  RegionSurface before, after;
  GluedMaps glued;
  FaceSources roots;
};

Uncut uncut(const LevelState& state, const std::vector<int>& patches) {
  Uncut out;
  const QuadGraph part = part_of(state.quads, patches);
  out.glued = glue_patch_maps(maps_of(state, patches, out.roots), part);
  std::vector<int> all(patches.size());
  std::iota(all.begin(), all.end(), 0);
  out.before = surface_of(out.glued.mapped.surface, *make_region(out.glued.mapped.surface, all));
  out.after = uncut_region(out.before, out.glued);
  return out;
}

TEST(RegionUncutting, OldSidesAreGoneAndTheSurfaceStays) {
  for (const int n : {1, 3, 7}) {
    LevelState state = two_squares(n);
    const int roots = state.quads.patch_count();
    for (int k = 0; k < 3; ++k) state = quadrisected(state);
    // Of each square two quadrants that lie side by side: the rim runs through triangles, and around two squares' common side.
    std::vector<int> patches;
    for (int q = 0; q < state.quads.patch_count(); ++q) {
      const DyadicSquare& s = state.maps[q].square;
      if (s.v + s.width <= 0.5 || q % (state.quads.patch_count() / roots) < 16) patches.push_back(q);
    }
    const Uncut made = uncut(state, patches);
    EXPECT_NEAR(area_of(made.after.mesh), area_of(made.before.mesh), 1e-6 * area_of(made.before.mesh));
    EXPECT_LT(made.after.mesh.faces.size(), made.before.mesh.faces.size() / (n == 1 ? 3 : 1.2));
    // The rim is as it was, point by point.
    ASSERT_EQ(made.after.sides.size(), made.before.sides.size());
    for (std::size_t k = 0; k < made.after.sides.size(); ++k) {
      ASSERT_EQ(made.after.sides[k].size(), made.before.sides[k].size());
      for (std::size_t i = 0; i < made.after.sides[k].size(); ++i)
        EXPECT_EQ(made.after.mesh.points[made.after.sides[k][i]], made.before.mesh.points[made.before.sides[k][i]]);
    }
    // Inside there are the maps' own vertices alone, and every face lies on the triangle that it names.
    std::set<int> rim;
    for (const auto& side : made.after.sides) rim.insert(side.begin(), side.end());
    for (std::size_t f = 0; f < made.after.mesh.faces.size(); ++f) {
      const int named = made.after.mesh.source_face[f], root = made.glued.on.face[named];
      const std::array<float, 9>& w = made.glued.on.weights[named];
      const int first = static_cast<int>(state.maps[0].map->triangles.size());
      const PatchMap& map = *state.maps[root < first ? 0 : state.quads.patch_count() - 1].map;
      const std::array<int, 3>& corners = map.triangles[root < first ? root : root - first];
      for (int i = 0; i < 3; ++i) {
        Vec3 at = Vec3::Zero();
        for (int k = 0; k < 3; ++k) at += static_cast<double>(w[3 * i + k]) * map.positions[corners[k]];
        const int v = made.after.mesh.faces[f][i];
        EXPECT_LT((at - made.after.mesh.points[v]).norm(), 1e-6);
        const bool vertex = w[3 * i] == 1 || w[3 * i + 1] == 1 || w[3 * i + 2] == 1;
        EXPECT_TRUE(vertex || rim.count(v)) << "a point of an old side is left inside";
      }
    }
  }
}

TEST(RegionUncutting, AWholeMapIsItsOwnTrianglesAgain) {
  LevelState state = two_squares(5);
  for (int k = 0; k < 2; ++k) state = quadrisected(state);
  std::vector<int> first(state.quads.patch_count() / 2);
  std::iota(first.begin(), first.end(), 0);
  const Uncut made = uncut(state, first);
  // But for those along the rim, which keeps the points of its quads' corners.
  EXPECT_LE(made.after.mesh.faces.size(), state.maps[0].map->triangles.size() + 4 * 3);
  EXPECT_GE(made.after.mesh.faces.size(), state.maps[0].map->triangles.size());
}

}  // namespace
}  // namespace hybrid_mesh
