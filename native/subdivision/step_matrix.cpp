// SPDX-License-Identifier: GPL-3.0-or-later
#include "subdivision/step_matrix.h"

#include <algorithm>
#include <array>

#include "base/disjoint_sets.h"
#include "hierarchy/vertex_index.h"
#include "subdivision/masks.h"

namespace hybrid_mesh {

namespace {

// The quads of one level among the faces of a mesh, as a manifold of their own. Where quads of this level touch at a vertex alone, others being
// coarser, there are two vertices of one name.
struct LevelPart {
  std::vector<int> nodes;  // #F
  QuadTopology quads;
  std::vector<int> edges;      // #E: the hierarchy's
  std::vector<VertexId> name;  // #V
};

void find_edges(const HybridMesh& hierarchy, LevelPart& part, std::vector<std::array<int, 4>>& half, std::vector<std::array<int, 2>>& sides) {
  PlaceIndex find;
  for (std::size_t f = 0; f < part.nodes.size(); ++f) {
    std::array<int, 4>& of_face = half.emplace_back();
    for (int i = 0; i < 4; ++i) {
      const HalfEdge h = hierarchy.half_edge(part.nodes[f], i);
      if (find(h >> 1) < 0) {
        find.set(h >> 1, static_cast<int>(part.edges.size()));
        part.edges.push_back(h >> 1);
        sides.push_back({-1, -1});
      }
      of_face[i] = 2 * find(h >> 1) + (h & 1);
      sides[of_face[i] >> 1][h & 1] = static_cast<int>(4 * f) + i;
    }
  }
}

LevelPart level_part(const HybridMesh& hierarchy, const QuadMesh& mesh, int level, BoundaryRule boundary) {
  LevelPart part;
  for (const int node : mesh.node)  // faces under one node follow each other
    if (hierarchy.level(node) == level && (part.nodes.empty() || part.nodes.back() != node)) part.nodes.push_back(node);
  std::vector<std::array<int, 4>> half;
  std::vector<std::array<int, 2>> sides;
  find_edges(hierarchy, part, half, sides);
  const auto next = [](int corner) { return corner / 4 * 4 + (corner + 1) % 4; };
  DisjointSets fans(4 * part.nodes.size());
  for (const auto& [left, right] : sides) {
    if (left < 0 || right < 0) continue;
    fans.join(left, next(right));
    fans.join(next(left), right);
  }
  std::vector<int> vertex_of(fans.count(), -1);
  const auto vertex_at = [&](int corner) {
    int& vertex = vertex_of[fans.find(corner)];
    if (vertex < 0) {
      vertex = static_cast<int>(part.name.size());
      part.name.push_back(hierarchy.corner(part.nodes[corner / 4], corner % 4));
    }
    return vertex;
  };
  for (const auto& [left, right] : sides) {
    if (left >= 0)
      part.quads.add_edge(vertex_at(left), vertex_at(next(left)));
    else
      part.quads.add_edge(vertex_at(next(right)), vertex_at(right));
  }
  for (const std::array<int, 4>& of_face : half) part.quads.add_face(of_face);
  part.quads.vertex_count = static_cast<int>(part.name.size());
  part.quads.vertex_sharpness.assign(part.name.size(), 0);
  part.quads.boundary = boundary;
  for (std::size_t f = 0; f < part.nodes.size(); ++f)
    for (int i = 0; i < 4; ++i)
      if (hierarchy.is_sharp(part.nodes[f], i)) part.quads.edge_sharpness[half[f][i] >> 1] = infinite_sharpness;
  return part;
}

// Which vertices, edges and faces of a part are of refined quads, in order.
struct Refined {
  std::vector<int> vertices, edges, faces;
};

Refined refined_of(const HybridMesh& hierarchy, const LevelPart& part) {
  std::vector<char> vertex(part.name.size(), 0), edge(part.edges.size(), 0);
  Refined result;
  for (std::size_t f = 0; f < part.nodes.size(); ++f) {
    if (hierarchy.first_child(part.nodes[f]) < 0) continue;
    result.faces.push_back(static_cast<int>(f));
    for (int i = 0; i < 4; ++i) vertex[part.quads.corners[f][i]] = edge[part.quads.half[f][i] >> 1] = 1;
  }
  for (std::size_t v = 0; v < vertex.size(); ++v)
    if (vertex[v]) result.vertices.push_back(static_cast<int>(v));
  for (std::size_t e = 0; e < edge.size(); ++e)
    if (edge[e]) result.edges.push_back(static_cast<int>(e));
  return result;
}

}  // namespace

StepMatrix step_matrix(const HybridMesh& hierarchy, const QuadMesh& coarse, int level, BoundaryRule boundary) {
  const LevelPart part = level_part(hierarchy, coarse, level - 1, boundary);
  const Refined refined = refined_of(hierarchy, part);
  StepMatrix result;
  if (refined.faces.empty()) {
    result.weights.resize(0, static_cast<Eigen::Index>(coarse.vertex_count()));
    return result;
  }
  const VertexIndex find(coarse.vertex);
  std::vector<const Mask*> rows;
  const RefinedMasks masks = refine_masks(part.quads, VertexFans(part.quads));
  result.corners = static_cast<int>(refined.vertices.size());
  result.midpoints = static_cast<int>(refined.edges.size());
  for (const int v : refined.vertices) {
    result.fine.push_back(part.name[v]);
    result.parent.push_back(find(part.name[v]));
    rows.push_back(&masks.vertices[v]);
  }
  for (const int e : refined.edges) {
    result.fine.emplace_back(VertexId::Kind::Edge, part.edges[e]);
    rows.push_back(&masks.edges[e]);
  }
  for (const int f : refined.faces) {
    result.refined.push_back(part.nodes[f]);
    result.fine.emplace_back(VertexId::Kind::Node, part.nodes[f]);
    rows.push_back(&masks.faces[f]);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (const auto& [vertex, weight] : *rows[r]) entries.emplace_back(static_cast<int>(r), find(part.name[vertex]), weight);
  result.weights.resize(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(coarse.vertex_count()));
  result.weights.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace hybrid_mesh
