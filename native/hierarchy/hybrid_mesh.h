// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "decoder/forest/quad_forest.h"
#include "parameterization/patch_map.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// Where a vertex lies: (u, v) in the unit square of `node`, which owns a map (or is a root, if nothing above has one).
struct MapLocation {
  int node = -1;
  double u = 0, v = 0;
};

// A mesh taken out of the hierarchy. Polygons as in PolygonSoup. The numbering depends on the hierarchy's structure alone, not on the
// order in which it was refined.
struct QuadMesh {
  std::vector<Vec3> points;              // #V
  std::vector<std::int64_t> offsets{0};  // #F + 1
  std::vector<std::int32_t> indices;
  std::vector<std::int32_t> node;     // #F: node under the face (several faces have the same after closure)
  std::vector<std::int32_t> root;     // #F: root of that node
  std::vector<VertexId> vertex;       // #V
  std::vector<MapLocation> location;  // #V: in the map of the first face that has the vertex
  std::vector<char> sharp;            // as `indices`: is the edge from this corner to the face's next one on a feature? Empty: none is

  std::size_t face_count() const { return offsets.size() - 1; }
  std::size_t vertex_count() const { return vertex.size(); }
  // Calls body(vertex) for the corners of a face, in order.
  template <class Body>
  void for_corners(std::size_t face, const Body& body) const {
    for (std::int64_t i = offsets[face]; i < offsets[face + 1]; ++i) body(indices[i]);
  }
};

PolygonSoup to_soup(const QuadMesh& mesh);

// A forest of quadtrees with maps to a surface and positions of its levels.
class HybridMesh : public QuadForest {
 public:
  HybridMesh() = default;
  explicit HybridMesh(QuadForest forest) : QuadForest(std::move(forest)) { count_leaves(); }

  // As of QuadForest.
  static HybridMesh from_base(int vertices, const std::vector<std::array<int, 4>>& quads, const std::vector<std::array<SideLink, 4>>& neighbours) {
    return HybridMesh(QuadForest::from_base(vertices, quads, neighbours));
  }
  static HybridMesh from_base(int vertices, const std::vector<std::array<int, 4>>& quads) {
    return HybridMesh(QuadForest::from_base(vertices, quads));
  }

  // --- places of vertices in maps ---------------------------------------------------------------------------------------------------------
  // A canonical place of the vertex in a map (see MapLocation).
  MapLocation locate(VertexId vertex) const;
  PatchSample sample(VertexId vertex) const { return sample(locate(vertex)); }
  // Throws Error{InvalidInput} if the node there has no map.
  PatchSample sample(const MapLocation& location) const;

  // --- maps ---------------------------------------------------------------------------------------------------------------------------------
  void set_map(int node, PatchMap map) { set_map(node, std::make_shared<const PatchMap>(std::move(map))); }
  void set_map(int node, std::shared_ptr<const PatchMap> map);
  const PatchMap* map(int node) const;  // the node's own, or null
  std::shared_ptr<const PatchMap> shared_map(int node) const;
  const PatchSampler* sampler(int node) const;
  int map_owner(int node) const;  // nearest self-or-ancestor that has one, or -1
  void drop_maps();
  bool has_maps() const;

  // --- extraction ---------------------------------------------------------------------------------------------------------------------------
  // Leaves up to level j (in a uniform hierarchy: all nodes of level j), closed. LevelKind::M leaves out the operations of level j. Positions:
  // those that were set for that level (N and M share them), else sampled from the maps, else zero. 0 <= j.
  QuadMesh level_mesh(int j, LevelKind kind = LevelKind::N) const { return level_mesh(j, kind, closure_); }
  QuadMesh level_mesh(int j, LevelKind kind, FaceClosure closure) const;
  // All leaves, closed. Positions: those set for the final mesh, else the maps', else zero.
  QuadMesh final_mesh() const { return final_mesh(closure_); }
  QuadMesh final_mesh(FaceClosure closure) const;
  // Keeps a mesh's points as the positions of its vertices on level j or in the final mesh, in addition to those kept before.
  void set_level_positions(int j, const QuadMesh& mesh);
  void set_final_positions(const QuadMesh& mesh);
  void clear_positions();
  bool has_level_positions(int j) const;
  bool has_final_positions() const { return !final_positions_.empty(); }

  // The same hierarchy with nodes, edges, vertices and operations numbered in canonical order (levels first), which depends on the structure alone.
  HybridMesh canonical() const;

 private:
  friend class HierarchyAccess;   // checks invariants
  friend class HierarchyArchive;  // takes apart and puts together

  struct MapSlot {
    explicit MapSlot(std::shared_ptr<const PatchMap> m) : map(std::move(m)), sampler(*map) {}
    std::shared_ptr<const PatchMap> map;
    PatchSampler sampler;
  };
  // Sorted by vertex.
  using Positions = std::vector<std::pair<VertexId, Vec3>>;

  QuadMesh level_mesh(int cap, LevelKind kind, FaceClosure closure, const Positions* positions) const;

  std::vector<std::shared_ptr<const MapSlot>> maps_;
  std::vector<Positions> level_positions_;
  Positions final_positions_;
};

// Every broken invariant in words; empty if there is none. Checks links, levels, manifoldness of the leaves and of every level, balance, operations,
// counts.
std::vector<std::string> find_defects(const HybridMesh& mesh);

}  // namespace hybrid_mesh
