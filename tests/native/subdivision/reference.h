// SPDX-License-Identifier: GPL-3.0-or-later
// Catmull-Clark subdivision by the book, and hierarchies to try it on.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/context.h"
#include "hierarchy/bases.h"
#include "hierarchy/repatches.h"
#include "subdivision/catmull_clark.h"

namespace hybrid_mesh {

using PointMap = std::map<VertexId, Vec3>;

struct ReferenceSharpness {
  std::map<int, double> edges;  // by edge of the hierarchy
  std::map<VertexId, double> vertices;
};

inline double finer_sharpness(double sharpness) { return sharpness >= 10 ? sharpness : std::max(0.0, sharpness - 1); }

// M^j from N^{j-1}: face points, edge points, vertex points. `sharpness` becomes that of M^j.
inline PointMap reference_step(const HybridMesh& hierarchy, const QuadMesh& mesh, BoundaryRule boundary, ReferenceSharpness& sharpness) {
  struct Edge {
    VertexId a, b;
    std::vector<Vec3> faces;
    double sharpness = 0;
  };
  struct Vertex {
    Vec3 point;
    std::vector<Vec3> faces;
    std::vector<int> edges;  // twice if it has both ends here
  };
  std::map<int, Edge> edges;
  std::map<VertexId, Vertex> vertices;
  PointMap result;
  ReferenceSharpness finer;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) vertices[mesh.vertex[v]].point = mesh.points[v];
  const auto given = [](const auto& list, auto key) {
    const auto found = list.find(key);
    return found == list.end() ? 0.0 : found->second;
  };
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const int node = mesh.node[f], child = hierarchy.first_child(node);
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < 4; ++i) centre += vertices[hierarchy.corner(node, i)].point / 4;
    result[VertexId(VertexId::Kind::Node, node)] = centre;
    for (int i = 0; i < 4; ++i) {
      vertices[hierarchy.corner(node, i)].faces.push_back(centre);
      const int e = hierarchy.half_edge(node, i) >> 1;
      Edge& edge = edges[e];
      edge.a = hierarchy.from(2 * e);
      edge.b = hierarchy.to(2 * e);
      edge.faces.push_back(centre);
      edge.sharpness = given(sharpness.edges, e);
      if (const double left = finer_sharpness(edge.sharpness); left > 0)
        finer.edges[hierarchy.half_edge(child + i, i) >> 1] = finer.edges[hierarchy.half_edge(child + (i + 1) % 4, i) >> 1] = left;
    }
  }
  for (auto& [e, edge] : edges) {
    if (edge.faces.size() == 1) edge.sharpness = 1e9;
    vertices[edge.a].edges.push_back(e);
    vertices[edge.b].edges.push_back(e);
    const Vec3 middle = (vertices[edge.a].point + vertices[edge.b].point) / 2;
    const double sharp = std::min(1.0, edge.sharpness);
    Vec3 smooth = middle;
    if (edge.faces.size() == 2) smooth = middle / 2 + (edge.faces[0] + edge.faces[1]) / 4;
    result[VertexId(VertexId::Kind::Edge, e)] = sharp * middle + (1 - sharp) * smooth;
  }
  for (const auto& entry : vertices) {
    const VertexId id = entry.first;
    const Vertex& vertex = entry.second;
    double own = given(sharpness.vertices, id);
    if (const double left = finer_sharpness(own); left > 0) finer.vertices[id] = left;
    if (vertex.faces.size() == 1 && vertex.edges.size() == 2 && boundary == BoundaryRule::EdgesAndCorners) own = 1e9;
    // The rule of this level and of the next, and how much the features that vanish between them weigh.
    const auto place = [&](bool next) {
      std::vector<VertexId> across;
      std::vector<int> ends = vertex.edges;
      for (std::size_t i = 0; i < ends.size(); ++i) {
        const Edge& edge = edges[ends[i]];
        // An edge with both ends here goes both ways.
        const bool second = std::count(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(i), ends[i]) > 0;
        const double s = next ? finer_sharpness(edge.sharpness) : edge.sharpness;
        if (s > 0) across.push_back(edge.a == id && !second ? edge.b : edge.a);
      }
      const double s = next ? finer_sharpness(own) : own;
      if (s > 0 || across.size() > 2) return vertex.point;
      if (across.size() == 2) return Vec3(0.75 * vertex.point + 0.125 * (vertices.at(across[0]).point + vertices.at(across[1]).point));
      const double n = static_cast<double>(vertex.faces.size());
      Vec3 face_mean = Vec3::Zero(), edge_mean = Vec3::Zero();
      for (const Vec3& face : vertex.faces) face_mean += face / n;
      for (const int e : vertex.edges) edge_mean += (vertices.at(edges[e].a).point + vertices.at(edges[e].b).point) / 2 / n;
      return Vec3((face_mean + 2 * edge_mean + (n - 3) * vertex.point) / n);
    };
    double sum = 0;
    int vanishing = 0;
    const auto weigh = [&](double s) {
      if (s <= 0 || finer_sharpness(s) > 0) return;
      sum += s;
      ++vanishing;
    };
    weigh(own);
    for (const int e : vertex.edges) weigh(edges[e].sharpness);
    const double weight = vanishing > 0 ? sum / vanishing : 0;
    result[id] = weight * place(false) + (1 - weight) * place(true);
  }
  sharpness = finer;
  return result;
}

inline Vec3 random_point(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double x = uniform(random), y = uniform(random);
  return {x, y, uniform(random)};
}

inline QuadMesh randomly_placed(QuadMesh mesh, std::mt19937& random) {
  for (Vec3& point : mesh.points) point = random_point(random);
  return mesh;
}

inline QuadMesh transformed(QuadMesh mesh, const Eigen::Matrix3d& linear, const Vec3& shift) {
  for (Vec3& point : mesh.points) point = linear * point + shift;
  return mesh;
}

// Sharp edges and vertices of a mesh at random, some for a while and some for ever.
inline CatmullClarkRules random_rules(const HybridMesh& hierarchy, const QuadMesh& mesh, BoundaryRule boundary, std::mt19937& random) {
  static const double kinds[] = {0, 0.25, 0.5, 1, 1.5, 2, 2.75, 10, 25};
  CatmullClarkRules rules;
  rules.boundary = boundary;
  for (const int node : mesh.node)
    for (int i = 0; i < 4; ++i)
      if (random() % 4 == 0) rules.creases.push_back({hierarchy.corner(node, i), hierarchy.corner(node, (i + 1) % 4), kinds[random() % 9]});
  for (const VertexId vertex : mesh.vertex)
    if (random() % 8 == 0) rules.vertices.push_back({vertex, kinds[random() % 9]});
  return rules;
}

// What rules say of the edges of a mesh.
inline ReferenceSharpness reference_sharpness(const HybridMesh& hierarchy, const QuadMesh& mesh, const CatmullClarkRules& rules) {
  ReferenceSharpness result;
  for (const Crease& crease : rules.creases)
    for (const int node : mesh.node)
      for (int i = 0; i < 4; ++i) {
        const VertexId from = hierarchy.corner(node, i), to = hierarchy.corner(node, (i + 1) % 4);
        if ((from == crease.a && to == crease.b) || (from == crease.b && to == crease.a))
          result.edges[hierarchy.half_edge(node, i) >> 1] = crease.sharpness;
      }
  for (const SharpVertex& vertex : rules.vertices) result.vertices[vertex.vertex] = vertex.sharpness;
  return result;
}

inline SubdividedMesh subdivided(const HybridMesh& hierarchy, const QuadMesh& start, int from, int to, const SubdivisionOptions& options = {}) {
  Context context;
  return subdivide(hierarchy, start, from, to, options, Progress(context));
}

inline std::vector<int> active_nodes(const HybridMesh& mesh, int level) {
  std::vector<int> result;
  for (int n = 0; n < mesh.node_count(); ++n)
    if (mesh.is_active(n) && mesh.level(n) == level && !mesh.is_root(n)) result.push_back(n);
  return result;
}

// Two levels of cubes, the second partly on the first, and a hole.
inline HybridMesh with_operations(HybridMesh mesh) {
  mesh.refine_uniform(1);
  const std::vector<int> first = active_nodes(mesh, 1);
  EXPECT_EQ(mesh.apply(cube_on(mesh, first[1])), "");
  mesh.refine_uniform(2);
  EXPECT_EQ(mesh.apply(cube_on(mesh, mesh.first_child(mesh.operation(0).roots[4]) + 2)), "");
  const std::vector<int> second = active_nodes(mesh, 2);
  EXPECT_EQ(mesh.apply(cube_on(mesh, second[second.size() / 2])), "");
  EXPECT_EQ(mesh.apply(opening(mesh, {second[second.size() / 3]})), "");
  mesh.refine_uniform(3);
  return mesh;
}

}  // namespace hybrid_mesh
