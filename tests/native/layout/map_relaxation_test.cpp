// SPDX-License-Identifier: GPL-3.0-or-later
#include "layout/operations/map_relaxation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "hierarchy/bases.h"
#include "parameterization/patch_energy.h"

namespace hybrid_mesh {
namespace {

// The 8 x 8 quads of one map.
LevelState quads_of(PatchMap map) {
  LevelState state;
  state.quads.nodes = {{0, 1, 2, 3}};
  state.quads.neighbours.resize(1);
  state.quads.node_count = 4;
  state.area = 1;
  state.maps.push_back({std::make_shared<const PatchMap>(std::move(map)), {}});
  for (int k = 0; k < 3; ++k) state = quadrisected(state);
  return state;
}

// A square, bent and unevenly mapped, by triangles that know nothing of its 8 x 8 quads.
LevelState square_of_quads() {
  return quads_of(
      make_map(5, 0.3, 5, [](double u, double v) { return Vec3(u * (0.6 + 0.4 * u), v + 0.2 * std::sin(3 * u) * v * (1 - v), 0.2 * u * v); }));
}

// A flat square; what is mapped to the corner (0, 0) lies beside it, where the boundary is straight: a patch between its four sides (Coons).
const Vec3 astray(0.125, 0, 0);
LevelState square_with_a_corner_astray() {
  const auto left = [](double v) { return v < astray.x() ? Vec3(astray.x() - v, 0, 0) : Vec3(0, (v - astray.x()) / (1 - astray.x()), 0); };
  return quads_of(make_map(16, 0, 1, [&](double u, double v) -> Vec3 {
    const Vec3 between_rows = Vec3((1 - v) * (1 - u) * astray.x() + u, v, 0), between_columns = (1 - u) * left(v) + u * Vec3(1, v, 0);
    return between_rows + between_columns - ((1 - u) * ((1 - v) * astray + Vec3(0, v, 0)) + u * Vec3(1, v, 0));
  }));
}

// Relaxes the maps of some quads together, and returns their energy.
double relax(LevelState& state, const std::vector<int>& quads) {
  FaceSources roots;
  GluedMaps glued = glue_patch_maps(maps_of(state, quads, roots), part_of(state.quads, quads));
  roots.trace(glued.on);
  std::vector<int> all(quads.size());
  std::iota(all.begin(), all.end(), 0);
  Context context;
  RelaxedMaps relaxed =
      relaxed_maps(glued.mapped, all, state.quads, quads, unit_quad_scale(state, state.quads), glued, GlobalMapOptions(), Progress(context));
  for (std::size_t k = 0; k < quads.size(); ++k) state.maps[quads[k]] = {std::make_shared<const PatchMap>(std::move(relaxed.maps[k])), {}};
  return relaxed.energy;
}

struct Measured {
  double area = 0;
  std::size_t points = 0;
};

Measured measured(const LevelState& state, const std::vector<int>& quads) {
  Measured out;
  for (const PatchMap& map : maps_of(state, quads)) {
    EXPECT_STREQ(find_map_defect(map), "");
    out.area += map_area(map);
    out.points += map.uv.size();
  }
  return out;
}

TEST(MapRelaxation, RepeatedItLeavesTheSurfaceAndDoesNotFillMapsWithPoints) {
  LevelState state = square_of_quads();
  const PatchMap root = *state.maps[0].map;
  std::vector<int> all(state.quads.patch_count());
  std::iota(all.begin(), all.end(), 0);
  const Measured before = measured(state, all);
  // Two parts in turn that share half of their quads, as the rings around neighbouring operations do.
  const std::vector<int> low(all.begin(), all.begin() + 40), high(all.begin() + 24, all.end());
  std::size_t first = 0;
  double energy = 0;
  for (int round = 0; round < 5; ++round) {
    const double now = relax(state, low) + relax(state, high);
    const Measured after = measured(state, all);
    EXPECT_NEAR(after.area, before.area, 1e-6);
    if (round == 0) first = after.points;
    EXPECT_LE(after.points, 1.3 * static_cast<double>(first)) << round;
    if (round == 0) energy = now;
    // Coarse versions differ by chance.
    EXPECT_LE(now, 1.05 * energy) << round;
  }
  // Each point lies where its source says.
  for (const PatchMap& map : maps_of(state, all))
    for (std::size_t t = 0; t < map.triangles.size(); ++t)
      for (int i = 0; i < 3; ++i) {
        const std::array<int, 3>& corners = root.triangles[map.source_face[t]];
        Vec3 p = Vec3::Zero();
        for (int k = 0; k < 3; ++k) p += static_cast<double>(map.source[t][3 * i + k]) * root.positions[corners[k]];
        EXPECT_LT((p - map.positions[map.triangles[t][i]]).norm(), 1e-5);
      }
}

// Where the corner (0, 0) of a level of one map lies.
Vec3 corner_of(const LevelState& state) {
  std::vector<int> all(state.quads.patch_count());
  std::iota(all.begin(), all.end(), 0);
  std::vector<int> quads_at(state.quads.node_count, 0);
  for (const auto& nodes : state.quads.nodes)
    for (const int n : nodes) ++quads_at[n];
  const std::vector<PatchMap> maps = maps_of(state, all);
  for (std::size_t q = 0; q < maps.size(); ++q)
    if (quads_at[state.quads.nodes[q][0]] == 1) return PatchSampler(maps[q])(0, 0).position;
  ADD_FAILURE() << "no quad has it";
  return Vec3::Zero();
}

TEST(MapRelaxation, CornersOnTheBoundaryGoWhereItTurns) {
  LevelState state = square_with_a_corner_astray();
  std::vector<int> all(state.quads.patch_count());
  std::iota(all.begin(), all.end(), 0);
  ASSERT_LT((corner_of(state) - astray).norm(), 1e-9);
  relax(state, all);
  measured(state, all);
  EXPECT_LT(corner_of(state).norm(), 1e-9);
}

TEST(MapRelaxation, WhatIsHeldStaysWhereItIs) {
  LevelState state = square_with_a_corner_astray();
  // All but the quads of three corners: what they share with the others ends on the boundary.
  std::vector<int> part, others;
  std::vector<int> quads_at(state.quads.node_count, 0);
  for (const auto& nodes : state.quads.nodes)
    for (const int n : nodes) ++quads_at[n];
  for (int q = 0; q < state.quads.patch_count(); ++q) {
    const auto& nodes = state.quads.nodes[q];
    const bool is_corner = std::any_of(nodes.begin(), nodes.end(), [&](int n) { return quads_at[n] == 1; });
    (is_corner && quads_at[nodes[0]] != 1 ? others : part).push_back(q);
  }
  ASSERT_EQ(others.size(), 3);
  const auto ends = [&] {
    std::vector<Vec3> points;
    for (const PatchMap& map : maps_of(state, others)) {
      const PatchSampler at(map);
      for (const double u : {0, 1})
        for (const double v : {0, 1}) points.push_back(at(u, v).position);
    }
    return points;
  };
  const std::vector<Vec3> before = ends();
  std::vector<int> all(state.quads.patch_count());
  std::iota(all.begin(), all.end(), 0);
  const double area = measured(state, all).area;
  relax(state, part);
  EXPECT_EQ(ends(), before);
  EXPECT_NEAR(measured(state, all).area, area, 1e-9);  // no gap, nothing twice
  EXPECT_LT(corner_of(state).norm(), 1e-9);
}

TEST(MapRelaxation, MapsKnowTheirOwnPoints) {
  LevelState state = square_of_quads();
  std::vector<int> all(state.quads.patch_count());
  std::iota(all.begin(), all.end(), 0);
  relax(state, all);
  const PatchMap root = *square_of_quads().maps[0].map;
  // What is not said to be put in is a vertex of the map that was cut.
  std::size_t own = 0;
  for (const PatchMap& map : maps_of(state, all)) {
    ASSERT_EQ(map.inserted.size(), map.uv.size());
    for (std::size_t v = 0; v < map.uv.size(); ++v) {
      if (map.is_inserted(v)) continue;
      ++own;
      double nearest = 1;
      for (const Vec3& p : root.positions) nearest = std::min(nearest, (p - map.positions[v]).norm());
      EXPECT_LT(nearest, 1e-12);
    }
  }
  EXPECT_GT(own, root.positions.size() / 2);
}

}  // namespace
}  // namespace hybrid_mesh
