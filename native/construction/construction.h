// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "construction/addressed_graph.h"
#include "decoder/disjoint_sets.h"
#include "hierarchy/hybrid_mesh.h"
#include "layout/level_state.h"

namespace hybrid_mesh {

// A hierarchy while it is made or edited, and the state of the level that operations act on, as one thing: an edit is applied once, to the state at
// once and to the hierarchy with the level's other edits. Edits of one level that share quads are one irregular operation.
class Construction {
 public:
  // `area`: of the surface that the quads are mapped to, which is of unit size; `surface`: its version.
  // `sizes`: see LevelState; with them the area is that in their metric.
  Construction(const QuadGraph& base, double area, SurfaceVersion surface = {}, std::shared_ptr<const SizeField> sizes = {});
  // A hierarchy with its maps and the state of one of its levels, which is refined to that level everywhere; `root_numbers`: of its root quads in
  // addresses, by node. Throws Error{InvalidInput} if a finer level has operations or there is a quad without a map.
  Construction(HybridMesh hierarchy, const std::vector<int>& root_numbers, int level);

  int level() const { return level_; }
  const AddressedGraph& quads() const { return quads_; }  // of the level, after its edits so far
  int node(int patch) const { return nodes_[patch]; }     // of the hierarchy; before the level's first edit, and once closed
  LevelState state() const { return {quads_.graph(), maps_, area_, placement_, surface_, sizes_}; }
  const SurfaceVersion& surface() const { return surface_; }

  void apply(MappedEdit mapped);
  void set_sharp(int base_quad, int side) { mesh_.set_sharp(base_quad, side); }
  // Gives a quad of the level a map of its own.
  void set_map(int patch, PatchMap map);

  // Hands the level's edits and maps to the hierarchy. No edit of this level can follow. Throws Error{InvalidInput} if the hierarchy refuses an
  // operation.
  void close();
  // close(), and on to the quadrants of all quads.
  void refine();

  // Once closed:
  HybridMesh& hierarchy() { return mesh_; }
  std::vector<int> root_numbers() const;  // per node: the number of a root quad in addresses, -1: no root
  // Per node: of a root quad, the event of the surface's topology that opened with the edit that made it; -1: none.
  std::vector<int> opened() const;

 private:
  struct Group {
    std::vector<int> removed, added;  // nodes; patches
  };
  // A node of the quads: a vertex of the level, or a new one.
  struct Vertex {
    VertexId old;
    int fresh = -1;
  };

  void begin_level();
  void change(const LayoutEdit& edit, int opens);
  void insert(const Group& group, bool towers, std::vector<int>& nodes);

  HybridMesh mesh_;
  int level_ = 0;
  AddressedGraph quads_;
  std::vector<QuadMap> maps_;  // per patch; without a map until one is set
  double area_ = 0;            // see LevelState
  Placement placement_;
  SurfaceVersion surface_;
  std::shared_ptr<const SizeField> sizes_;
  std::vector<std::pair<int, int>> root_number_;  // node, number
  std::vector<std::pair<int, int>> opened_;       // node, event
  bool closed_ = false;
  // Of the level:
  std::vector<int> nodes_;  // per patch of it as it began; once closed, as it is
  std::vector<char> own_;   // per patch: has been given a map on this level
  // Its edits, gathered to operations on disjoint sets of its quads:
  std::vector<int> patches_;      // per patch: its number among all that there ever were on this level
  DisjointSets groups_;           // of numbers: what belongs to one operation
  std::vector<char> towers_;      // per number: its group grows skin and does nothing else
  std::vector<int> opens_;        // per number: the event that opened with the edit that made it, or -1
  std::vector<Vertex> vertices_;  // per node of the quads
  int fresh_ = 0;
};

}  // namespace hybrid_mesh
