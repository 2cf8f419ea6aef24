// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameterization/patch_gluing.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"

namespace hybrid_mesh {
namespace {

int find(std::vector<int>& parent, int v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

// The vertices of a map along one side, in its direction.
std::vector<int> side_chain(const PatchMap& map, int side) {
  const int across = (side + 1) % 2, along = side % 2;
  const double level = side == 1 || side == 2 ? 1 : 0;
  std::vector<int> chain;
  for (int v = 0; v < static_cast<int>(map.uv.size()); ++v)
    if (map.uv[v][across] == level) chain.push_back(v);
  std::sort(chain.begin(), chain.end(), [&](int a, int b) { return map.uv[a][along] < map.uv[b][along]; });
  if (side >= 2) std::reverse(chain.begin(), chain.end());
  return chain;
}

}  // namespace

MappedSurface glue_patch_maps(const std::vector<PatchMap>& maps, const PatchedSurface& layout,
                              const std::vector<std::array<int, 3>>& repaired_faces) {
  const int patches = static_cast<int>(maps.size());
  std::vector<int> offset(patches + 1, 0);
  for (int q = 0; q < patches; ++q) offset[q + 1] = offset[q] + static_cast<int>(maps[q].uv.size());
  std::vector<int> parent(offset.back());
  std::iota(parent.begin(), parent.end(), 0);
  std::vector<std::array<std::vector<int>, 4>> chains(patches);
  for (int q = 0; q < patches; ++q)
    for (int i = 0; i < 4; ++i) {
      chains[q][i] = side_chain(maps[q], i);
      for (int& v : chains[q][i]) v += offset[q];
    }
  for (int q = 0; q < patches; ++q)
    for (int i = 0; i < 4; ++i) {
      const PatchSide other = layout.neighbours[q][i];
      if (other.patch < 0) continue;
      const std::vector<int>&a = chains[q][i], &b = chains[other.patch][other.side];
      if (a.size() != b.size()) throw Error(ErrorCode::Internal, "the maps of two neighbouring patches do not share their side");
      for (std::size_t k = 0; k < a.size(); ++k) {
        const int x = find(parent, a[k]), y = find(parent, b[b.size() - 1 - k]);
        parent[std::max(x, y)] = std::min(x, y);
      }
    }
  MappedSurface out;
  TriangleSurface& mesh = out.surface.mesh;
  std::vector<int> point(offset.back(), -1);
  for (int q = 0; q < patches; ++q)
    for (int v = offset[q]; v < offset[q + 1]; ++v) {
      const int root = find(parent, v);
      if (point[root] < 0) {
        point[root] = static_cast<int>(mesh.points.size());
        mesh.points.push_back(maps[q].positions[v - offset[q]]);
      }
      point[v] = point[root];
    }
  out.surface.source.resize(mesh.points.size());
  std::vector<char> known(mesh.points.size(), 0);
  for (int q = 0; q < patches; ++q)
    for (std::size_t t = 0; t < maps[q].triangles.size(); ++t) {
      const std::array<int, 3>& corners = maps[q].triangles[t];
      const std::array<int, 3>& source = repaired_faces[maps[q].source_face[t]];
      std::array<int, 3> face;
      std::array<Vec2, 3> uv;
      for (int i = 0; i < 3; ++i) {
        face[i] = point[offset[q] + corners[i]];
        uv[i] = maps[q].uv[corners[i]];
        if (known[face[i]]) continue;
        known[face[i]] = 1;
        PointSource& s = out.surface.source[face[i]];
        double sum = 0;
        int n = 0;
        for (int k = 0; k < 3; ++k) {
          const double w = maps[q].source[t][3 * i + k];
          if (!(w > 0)) continue;
          s.vertices[n] = source[k];
          s.weights[n++] = w;
          sum += w;
        }
        for (double& w : s.weights) w /= sum;
      }
      mesh.faces.push_back(face);
      mesh.source_face.push_back(maps[q].source_face[t]);
      out.surface.patch.push_back(q);
      out.corners.push_back(uv);
    }
  connect_half_edges(mesh);
  out.surface.nodes = layout.nodes;
  out.surface.neighbours = layout.neighbours;
  out.surface.node_count = layout.node_count;
  out.surface.sides.resize(patches);
  for (int q = 0; q < patches; ++q)
    for (int i = 0; i < 4; ++i)
      for (const int v : chains[q][i]) out.surface.sides[q][i].push_back(point[v]);
  return out;
}

}  // namespace hybrid_mesh
