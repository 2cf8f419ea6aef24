// SPDX-License-Identifier: GPL-3.0-or-later
// Small base domains and maps for the tests of the hierarchy and of the container.
#pragma once

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "hierarchy/hybrid_mesh.h"

namespace hybrid_mesh {

struct Base {
  std::string name;
  HybridMesh mesh;
  int euler, boundary_loops;
  bool simple;  // no two quads share two edges or are glued to themselves
};

inline HybridMesh cube() { return HybridMesh::from_base(8, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}); }

inline HybridMesh grid(int columns, int rows) {
  std::vector<std::array<int, 4>> quads;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const int a = y * (columns + 1) + x, b = a + columns + 1;
      quads.push_back({a, a + 1, b + 1, b});
    }
  return HybridMesh::from_base((columns + 1) * (rows + 1), quads);
}

inline HybridMesh torus(int columns, int rows) {
  std::vector<std::array<int, 4>> quads;
  std::vector<std::array<SideLink, 4>> links;
  const auto at = [&](int x, int y) { return (y + rows) % rows * columns + (x + columns) % columns; };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      quads.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)});
      links.push_back({SideLink{at(x, y - 1), 2}, SideLink{at(x + 1, y), 3}, SideLink{at(x, y + 1), 0}, SideLink{at(x - 1, y), 1}});
    }
  return HybridMesh::from_base(columns * rows, quads, links);
}

// Two quads glued along all four sides.
inline HybridMesh pillow() {
  return HybridMesh::from_base(
      4, {{0, 1, 2, 3}, {0, 3, 2, 1}},
      {{SideLink{1, 3}, SideLink{1, 2}, SideLink{1, 1}, SideLink{1, 0}}, {SideLink{0, 3}, SideLink{0, 2}, SideLink{0, 1}, SideLink{0, 0}}});
}

inline std::vector<Base> bases() {
  std::vector<Base> result;
  result.push_back({"cube", cube(), 2, 0, true});
  result.push_back({"quad", grid(1, 1), 1, 1, true});
  result.push_back({"grid", grid(3, 2), 1, 1, true});
  result.push_back({"pillow", pillow(), 2, 0, false});
  result.push_back({"torus", torus(3, 3), 0, 0, true});
  result.push_back({"torus of two", torus(2, 1), 0, 0, false});
  result.push_back({"torus of one", torus(1, 1), 0, 0, false});
  return result;
}

// A map of the unit square with n x n cells of two triangles, to position(u, v); inner vertices shaken by `shake` cells.
template <class Position>
PatchMap make_map(int n, double shake, unsigned seed, const Position& position) {
  PatchMap map;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-shake, shake);
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      Vec2 uv(static_cast<double>(x) / n, static_cast<double>(y) / n);
      if (x > 0 && x < n && y > 0 && y < n) uv += Vec2(uniform(random), uniform(random)) / n;
      map.uv.push_back(uv);
      map.positions.push_back(position(uv.x(), uv.y()));
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x, b = a + n + 1;
      map.triangles.push_back({a, a + 1, b + 1});
      map.triangles.push_back({a, b + 1, b});
    }
  for (std::size_t t = 0; t < map.triangles.size(); ++t) {
    map.source_face.push_back(static_cast<int>(t));
    map.source.push_back({1, 0, 0, 0, 1, 0, 0, 0, 1});
  }
  return map;
}

// Euler characteristic, boundary loops and manifoldness of an extracted mesh, edges told apart by the hierarchy's own names of their ends:
// two polygons may share several edges only in meshes of very few quads.
struct SoupTopology {
  int vertices = 0, edges = 0, faces = 0, euler = 0, boundary_edges = 0, boundary_loops = 0, not_quads = 0;
  bool manifold = true;
};

inline SoupTopology soup_topology(const QuadMesh& mesh) {
  SoupTopology t;
  t.vertices = static_cast<int>(mesh.vertex_count());
  t.faces = static_cast<int>(mesh.face_count());
  std::map<std::pair<int, int>, int> half;
  std::vector<int> fans(mesh.vertex_count(), 0);
  for (int f = 0; f < t.faces; ++f) {
    const int begin = static_cast<int>(mesh.offsets[f]), count = static_cast<int>(mesh.offsets[f + 1]) - begin;
    t.not_quads += count != 4;
    for (int i = 0; i < count; ++i)
      if (++half[{mesh.indices[begin + i], mesh.indices[begin + (i + 1) % count]}] > 1) t.manifold = false;
  }
  std::map<int, int> next;
  for (const auto& [ends, n] : half) {
    const bool twin = half.count({ends.second, ends.first});
    if (!twin || ends.first < ends.second) ++t.edges;
    if (twin) continue;
    ++t.boundary_edges;
    if (!next.try_emplace(ends.first, ends.second).second) t.manifold = false;
  }
  std::set<int> seen;
  for (const auto& [a, b] : next) {
    if (seen.count(a)) continue;
    ++t.boundary_loops;
    for (int v = a; next.count(v) && seen.insert(v).second;) v = next[v];
  }
  // One fan a vertex: walk from face to face through its edges.
  std::map<std::pair<int, int>, int> face_of;
  std::vector<std::vector<int>> around(mesh.vertex_count());
  for (int f = 0; f < t.faces; ++f) {
    const int begin = static_cast<int>(mesh.offsets[f]), count = static_cast<int>(mesh.offsets[f + 1]) - begin;
    for (int i = 0; i < count; ++i) {
      face_of[{mesh.indices[begin + i], mesh.indices[begin + (i + 1) % count]}] = begin + i;
      around[mesh.indices[begin + i]].push_back(f);
    }
  }
  for (int v = 0; v < t.vertices; ++v) {
    if (around[v].empty()) t.manifold = false;
    if (around[v].empty()) continue;
    // Steps counter-clockwise from every start until none is left; the number of fans is that of boundary ends, or of cycles.
    std::map<int, int> step;  // outgoing neighbour -> incoming neighbour (next outgoing one)
    for (int f : around[v]) {
      const int begin = static_cast<int>(mesh.offsets[f]), count = static_cast<int>(mesh.offsets[f + 1]) - begin;
      for (int i = 0; i < count; ++i)
        if (mesh.indices[begin + i] == v) step[mesh.indices[begin + (i + 1) % count]] = mesh.indices[begin + (i + count - 1) % count];
    }
    std::set<int> targets;
    for (const auto& [a, b] : step) targets.insert(b);
    int start = step.begin()->first;
    for (const auto& [a, b] : step)
      if (!targets.count(a)) start = a;
    std::size_t length = 0;
    for (int a = start; step.count(a) && length <= step.size();) {
      ++length;
      a = step[a];
      if (a == start) break;
    }
    if (length != step.size() || step.size() != around[v].size()) t.manifold = false;
  }
  t.euler = t.vertices - t.edges + t.faces;
  return t;
}

}  // namespace hybrid_mesh
