// SPDX-License-Identifier: GPL-3.0-or-later
// Plans and what is made of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "generated_surfaces.h"
#include "remesh/remesh.h"
#include "surface/topology_summary.h"

namespace hybrid_mesh::testing {

using Json = nlohmann::ordered_json;

inline PolygonSoup spiked_ball(int n) {
  PolygonSoup soup = ball(n);
  for (Vec3& p : soup.points) {
    const double r = p.norm(), z = p.z() / r;
    if (z > 0.9) p.z() += 12 * (z - 0.9) * r;
  }
  return soup;
}

inline RemeshResult run(const PolygonSoup& soup, RemeshOptions options, const std::string& plan = "") {
  options.plan = plan;
  Context context;
  return remesh(soup, options, context);
}

// What the library says where it refuses to do `work`, with one of these codes; empty where it does it.
template <typename Work>
std::string refusal_of(Work&& work, std::initializer_list<ErrorCode> codes = {ErrorCode::InvalidInput}) {
  try {
    work();
  } catch (const Error& e) {
    EXPECT_NE(std::find(codes.begin(), codes.end(), e.code()), codes.end()) << e.what();
    return e.what();
  }
  return "";
}

inline Json cube_plan() {
  Json plan = {{"format", "hybrid-mesh plan"}, {"version", 1}};
  Json nodes = Json::array();
  for (const double z : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double x : {-1.0, 1.0}) nodes.push_back({x, y, z});
  plan["base"]["nodes"] = nodes;
  plan["base"]["quads"] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return plan;
}

inline int node_at(const HybridMesh& mesh, int root, const std::vector<int>& children) {
  int node = root;
  for (const int c : children) node = mesh.first_child(node) + c;
  return node;
}

// Where the vertices of a level lie, by node and corner.
inline std::map<std::pair<int, int>, Vec3> corners_of(const HybridMesh& mesh, int level) {
  std::map<VertexId, Vec3> at;
  const QuadMesh m = mesh.level_mesh(level);
  for (std::size_t v = 0; v < m.vertex.size(); ++v) at[m.vertex[v]] = mesh.sample(m.vertex[v]).position;
  std::map<std::pair<int, int>, Vec3> out;
  for (const int node : m.node)
    for (int i = 0; i < 4; ++i) out[{node, i}] = at.at(mesh.corner(node, i));
  return out;
}

// The hierarchy is sound, of a ball's topology, and on `level` everything that has no map of its own lies where it lay. Returns how many quads of the
// level have one.
inline int expect_changed_in_places(const HybridMesh& plain, const HybridMesh& made, int level) {
  EXPECT_TRUE(find_defects(made).empty());
  EXPECT_EQ(summarize_topology(to_soup(made.final_mesh())).euler, 2);
  int own = 0;
  for (int n = 0; n < made.node_count(); ++n) {
    if (const PatchMap* map = made.map(n)) {
      EXPECT_STREQ(find_map_defect(*map), "") << n;
      own += made.level(n) == level;
    }
  }
  const auto before = corners_of(plain, level), after = corners_of(made, level);
  int same = 0;
  for (const auto& [corner, p] : after) {
    const int node = corner.first;
    if (made.map(node) || made.inserted_by(node) >= 0) continue;
    EXPECT_NEAR((p - before.at(corner)).norm(), 0, 1e-9);
    ++same;
  }
  EXPECT_EQ(same + 4 * own, static_cast<int>(after.size()));
  return own;
}

}  // namespace hybrid_mesh::testing
