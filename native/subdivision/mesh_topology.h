// SPDX-License-Identifier: GPL-3.0-or-later
// Private to subdivision/.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "subdivision/quad_topology.h"

namespace hybrid_mesh {

// Finds places in a list of different numbers from 0 on.
class PlaceIndex {
 public:
  PlaceIndex() = default;
  explicit PlaceIndex(const std::vector<int>& numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i) set(numbers[i], static_cast<int>(i));
  }
  void set(int number, int place) {
    const auto i = static_cast<std::size_t>(number);
    if (i >= places_.size()) places_.resize(std::max(i + 1, 2 * places_.size()), -1);
    places_[i] = place;
  }
  // -1: not in the list.
  int operator()(int number) const { return static_cast<std::size_t>(number) < places_.size() ? places_[number] : -1; }

 private:
  std::vector<int> places_;
};

// Finds places in a list of vertices.
class VertexIndex {
 public:
  explicit VertexIndex(const std::vector<VertexId>& vertices);
  int operator()(VertexId vertex) const { return vertex.valid() ? of_kind_[vertex.code & 3](vertex.index()) : -1; }

 private:
  std::array<PlaceIndex, 4> of_kind_;  // one of them for names that no hierarchy has
};

// A mesh of whole nodes: face f is node mesh.node[f], and corners and sides are the node's.
struct MeshTopology {
  QuadTopology quads;
  std::vector<int> edges;  // #E: the hierarchy's edges

  // Throws Error{InvalidInput} if the mesh is of another kind.
  MeshTopology(const HybridMesh& hierarchy, const QuadMesh& mesh);
};

// Sharpness of the edges and vertices of a level, by the hierarchy's edges and vertices; sorted, each once.
struct Sharpness {
  std::vector<std::pair<int, float>> edges;
  std::vector<std::pair<VertexId, float>> vertices;
};

// Gives a topology the sharpness that rules speak of. Throws Error{InvalidInput} if there is no such edge or vertex, or no such sharpness.
void apply_rules(const CatmullClarkRules& rules, const QuadMesh& mesh, MeshTopology& topology);
// Sharpness left one level below, of the edges' parts and of the vertices. The nodes of the mesh must be refined.
Sharpness refined_sharpness(const HybridMesh& hierarchy, const QuadMesh& mesh, const MeshTopology& topology);
// Gives a topology the sharpness of those edges and vertices that it has.
void apply_sharpness(const Sharpness& sharpness, const QuadMesh& mesh, MeshTopology& topology);
// The rules under which a topology has the sharpness that it has.
CatmullClarkRules rules_of(const QuadMesh& mesh, const MeshTopology& topology);

}  // namespace hybrid_mesh
