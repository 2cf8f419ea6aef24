// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/mesh_topology.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "subdivision/masks.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

std::string name_of(VertexId vertex) {
  static const char* const kinds[] = {"free vertex ", "midpoint of edge ", "centre of node ", "unknown vertex "};
  return kinds[vertex.code & 3] + std::to_string(vertex.index());
}

float checked(double sharpness, const std::string& what) {
  // A number that is none compares as false.
  if (!(sharpness >= 0)) refuse("the sharpness of " + what + " is " + std::to_string(sharpness) + "; it must be 0 or more");
  return static_cast<float>(std::min<double>(sharpness, infinite_sharpness));
}

}  // namespace

MeshTopology::MeshTopology(const HybridMesh& hierarchy, const QuadMesh& mesh) {
  const auto face_count = static_cast<int>(mesh.face_count());
  if (face_count == 0) refuse("a mesh without faces cannot be subdivided");
  quads.vertex_count = static_cast<int>(mesh.vertex_count());
  quads.vertex_sharpness.assign(mesh.vertex_count(), 0);
  PlaceIndex find;  // edges by those of the hierarchy
  for (int f = 0; f < face_count; ++f) {
    const int node = mesh.node[f];
    if (node < 0 || node >= hierarchy.node_count()) refuse("face " + std::to_string(f) + " is of no node of the hierarchy");
    const std::int64_t begin = mesh.offsets[f];
    bool whole = mesh.offsets[f + 1] - begin == 4;
    for (int i = 0; i < 4 && whole; ++i) whole = mesh.vertex[mesh.indices[begin + i]] == hierarchy.corner(node, i);
    if (!whole) refuse("face " + std::to_string(f) + " is no whole quad of the hierarchy: subdivision needs a level without hanging nodes");
    std::array<int, 4> half;
    for (int i = 0; i < 4; ++i) {
      const HalfEdge h = hierarchy.half_edge(node, i);
      if (find(h >> 1) < 0) {
        int from = mesh.indices[begin + i], to = mesh.indices[begin + (i + 1) % 4];
        if (h & 1) std::swap(from, to);
        find.set(h >> 1, quads.edge_count());
        quads.add_edge(from, to);
        edges.push_back(h >> 1);
      }
      half[i] = 2 * find(h >> 1) + (h & 1);
      if (quads.side_of(half[i]) >= 0) refuse("node " + std::to_string(node) + " or a neighbour of it appears twice in the mesh");
    }
    quads.add_face(half);
  }
}

void apply_rules(const CatmullClarkRules& rules, const QuadMesh& mesh, MeshTopology& topology) {
  QuadTopology& quads = topology.quads;
  quads.boundary = rules.boundary;
  if (rules.creases.empty() && rules.vertices.empty()) return;
  const VertexIndex find(mesh.vertex);
  if (!rules.creases.empty()) {
    // Edges by their lower end.
    std::vector<std::array<int, 3>> by_ends;
    for (int e = 0; e < quads.edge_count(); ++e)
      by_ends.push_back({std::min(quads.ends[e][0], quads.ends[e][1]), std::max(quads.ends[e][0], quads.ends[e][1]), e});
    std::sort(by_ends.begin(), by_ends.end());
    for (std::size_t i = 0; i < rules.creases.size(); ++i) {
      const Crease& crease = rules.creases[i];
      const int a = find(crease.a), b = find(crease.b);
      const std::string what = "crease " + std::to_string(i) + ", from " + name_of(crease.a) + " to " + name_of(crease.b) + ",";
      const float sharpness = checked(crease.sharpness, what);
      const std::array<int, 3> ends{std::min(a, b), std::max(a, b), 0};
      auto found = std::lower_bound(by_ends.begin(), by_ends.end(), ends);
      const auto matches = [&] { return found != by_ends.end() && (*found)[0] == ends[0] && (*found)[1] == ends[1]; };
      if (ends[0] < 0 || !matches()) refuse(what + " is no edge of the mesh");
      for (; matches(); ++found) quads.edge_sharpness[(*found)[2]] = sharpness;
    }
  }
  for (std::size_t i = 0; i < rules.vertices.size(); ++i) {
    const int v = find(rules.vertices[i].vertex);
    const std::string what = "sharp vertex " + std::to_string(i) + ", " + name_of(rules.vertices[i].vertex) + ",";
    const float sharpness = checked(rules.vertices[i].sharpness, what);
    if (v < 0) refuse(what + " is no vertex of the mesh");
    quads.vertex_sharpness[v] = sharpness;
  }
}

Sharpness refined_sharpness(const HybridMesh& hierarchy, const QuadMesh& mesh, const MeshTopology& topology) {
  const QuadTopology& quads = topology.quads;
  Sharpness result;
  for (int e = 0; e < quads.edge_count(); ++e) {
    const float left = refined_sharpness(quads.edge_sharpness[e]);
    if (left <= 0) continue;
    const int side = quads.sides[e][quads.sides[e][0] < 0];
    const int child = hierarchy.first_child(mesh.node[side / 4]), s = side % 4;
    result.edges.emplace_back(hierarchy.half_edge(child + s, s) >> 1, left);
    result.edges.emplace_back(hierarchy.half_edge(child + (s + 1) % 4, s) >> 1, left);
  }
  for (int v = 0; v < quads.vertex_count; ++v) {
    const float left = refined_sharpness(quads.vertex_sharpness[v]);
    if (left > 0) result.vertices.emplace_back(mesh.vertex[v], left);
  }
  std::sort(result.edges.begin(), result.edges.end());
  std::sort(result.vertices.begin(), result.vertices.end());
  return result;
}

void apply_sharpness(const Sharpness& sharpness, const QuadMesh& mesh, MeshTopology& topology) {
  const auto find = [](const auto& list, auto key) {
    const auto found = std::lower_bound(list.begin(), list.end(), key, [](const auto& entry, auto k) { return entry.first < k; });
    return found != list.end() && found->first == key ? found->second : 0.0F;
  };
  if (!sharpness.edges.empty())
    for (std::size_t e = 0; e < topology.edges.size(); ++e) topology.quads.edge_sharpness[e] = find(sharpness.edges, topology.edges[e]);
  if (!sharpness.vertices.empty())
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) topology.quads.vertex_sharpness[v] = find(sharpness.vertices, mesh.vertex[v]);
}

CatmullClarkRules rules_of(const QuadMesh& mesh, const MeshTopology& topology) {
  const QuadTopology& quads = topology.quads;
  CatmullClarkRules rules;
  rules.boundary = quads.boundary;
  for (int e = 0; e < quads.edge_count(); ++e)
    if (quads.edge_sharpness[e] > 0) rules.creases.push_back({mesh.vertex[quads.ends[e][0]], mesh.vertex[quads.ends[e][1]], quads.edge_sharpness[e]});
  for (int v = 0; v < quads.vertex_count; ++v)
    if (quads.vertex_sharpness[v] > 0) rules.vertices.push_back({mesh.vertex[v], quads.vertex_sharpness[v]});
  return rules;
}

}  // namespace hybrid_mesh
