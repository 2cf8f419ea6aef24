// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "decoder/forest/level_mesh.h"
#include "decoder/forest/names.h"

namespace hybrid_mesh {

class Growth;

// The connectivity of a hierarchy: a forest of quadtrees, whose roots are the base's quads and those that irregular operations put in.
class QuadForest {
 public:
  static constexpr int max_level = 24;

  QuadForest() = default;

  // --- base -----------------------------------------------------------------------------------------------------------------------
  // Quads with corners counter-clockwise and, for each side, the side it is glued to. Quads may share several edges or all four corners,
  // and a quad may be glued to itself. Throws Error{InvalidInput} if links are not symmetric, do not run between the same corners in opposite
  // directions, a vertex is unused or has more than one fan.
  static QuadForest from_base(int vertices, const std::vector<std::array<int, 4>>& quads, const std::vector<std::array<SideLink, 4>>& neighbours);
  // Neighbours derived from pairs of corners. Throws also if two sides run between the same corners in the same direction.
  static QuadForest from_base(int vertices, const std::vector<std::array<int, 4>>& quads);

  // --- the forest; nodes are indices in [0, node_count()), base quads come first ----------------------------------------------------
  int node_count() const { return static_cast<int>(nodes_.size()); }
  int base_count() const { return base_count_; }
  int base_vertex_count() const { return base_vertices_; }
  int level(int node) const { return nodes_[node].level; }
  int parent(int node) const { return nodes_[node].parent; }  // -1: root
  bool is_root(int node) const { return nodes_[node].parent < 0; }
  // First of four consecutive children, quadrants (0,0), (1,0), (1,1), (0,1) of the parent's square; -1: not instantiated.
  int first_child(int node) const { return nodes_[node].child; }
  int root(int node) const { return nodes_[node].root; }
  int inserted_by(int node) const { return nodes_[nodes_[node].root].operation; }         // operation that made the node's root, -1: base
  int removed_by(int node) const { return is_root(node) ? -1 : nodes_[node].operation; }  // operation that removes the node, -1: none
  // Active: in the tree of the enabled operations, i.e. neither removed nor below a removed node nor below a root not inserted.
  bool is_active(int node) const { return nodes_[node].active; }
  bool is_leaf(int node) const { return nodes_[node].active && nodes_[node].child < 0; }
  std::vector<int> leaves() const;  // in the order of extraction
  std::vector<int> roots() const;   // active ones, base first, then by operation
  int depth() const;                // highest level of an active node
  HalfEdge half_edge(int node, int side) const { return nodes_[node].half[side]; }
  // Whether a node's side is on a feature of the surface, which vertices on it follow. What a side of the base is, all its parts are.
  bool is_sharp(int node, int side) const { return edges_[nodes_[node].half[side] >> 1].sharp; }
  bool is_sharp_edge(int edge) const { return edges_[edge].sharp; }
  void set_sharp(int base_quad, int side);
  void take_sharp_sides(const QuadForest& other);  // of a hierarchy with the same base
  bool has_sharp_sides() const { return has_sharp_sides_; }
  // Whether a side of a root quad, or a part of it, is on the plane in which the mesh is to be mirrored (see mirrored()). It is no part of what is
  // saved.
  bool is_on_mirror(int node, int side) const { return edges_[nodes_[node].half[side] >> 1].on_mirror; }
  void set_on_mirror(int root, int side);
  VertexId corner(int node, int i) const { return from(nodes_[node].half[i]); }
  // Square of the node in that of an ancestor: lower corner and width.
  struct Square {
    double u = 0, v = 0, width = 1;
  };
  Square square_in(int node, int ancestor) const;

  // --- vertices ---------------------------------------------------------------------------------------------------------------------
  VertexId from(HalfEdge h) const { return (h & 1) ? edges_[h >> 1].to : edges_[h >> 1].from; }
  VertexId to(HalfEdge h) const { return from(h ^ 1); }
  int birth_level(VertexId vertex) const;
  // Names as numbers below vertex_slots(), for lists by vertex.
  std::size_t vertex_slot(VertexId vertex) const {
    const std::size_t i = vertex.index();
    if (vertex.kind() == VertexId::Kind::Free) return i;
    return vertex.kind() == VertexId::Kind::Edge ? free_.size() + i : free_.size() + edges_.size() + i;
  }
  std::size_t vertex_slots() const { return free_.size() + edges_.size() + nodes_.size(); }
  int edge_count() const { return static_cast<int>(edges_.size()); }

  // --- neighbours (among active nodes) --------------------------------------------------------------------------------------------------
  // The node across a side, of equal level (leaf or refined), or a coarser leaf; with its side. Across root quads, removed quads and
  // inserted patches alike. Not valid at a boundary.
  SideLink neighbour(int node, int side) const;
  // Explicit link of a root quad (equal level only).
  SideLink root_neighbour(int root, int side) const { return neighbour(root, side); }
  // Link that a removed quad keeps: the inserted root quad that took the place along its side. Not valid if there is none.
  SideLink removed_neighbour(int node, int side) const;
  // The leaves across a side: one (equal or coarser), or several finer ones from corner `side` to corner `side` + 1.
  std::vector<SideLink> leaf_neighbours(int node, int side) const;
  // Leaves that touch a corner of a node, the node's own among them, counter-clockwise, each once.
  std::vector<int> leaves_at_corner(int node, int corner) const;
  // Whether a side has a finer leaf across.
  bool has_finer_neighbour(int node, int side) const;

  // --- regular refinement --------------------------------------------------------------------------------------------------------------
  // Instantiates the four children and returns the first (the present one if refined already). Throws Error{Unsupported} beyond max_level.
  int refine(int node);
  // Makes room for the refinement of all of a base's quads to a level.
  void reserve_levels(int level);
  // Refines a leaf and whatever else must be so that leaves that touch (by edge or vertex) differ by at most one level, no leaf has finer
  // neighbours on three or four sides, and none across a sharp side: a hanging node there, which the feature holds, would be a straight corner. All
  // refined nodes are appended to `refined`, in order.
  void refine_balanced(int leaf, std::vector<int>* refined = nullptr);
  // Until every leaf has at least this level.
  void refine_uniform(int levels);
  // Makes the conditions of refine_balanced hold everywhere.
  void balance(std::vector<int>* refined = nullptr);

  // Counts of the mesh of all leaves, hanging nodes being vertices; kept up to date by every refinement (O(1)).
  struct LeafCounts {
    std::int64_t vertices = 0, faces = 0, hanging = 0;
    std::int64_t euler = 0;
  };
  LeafCounts leaf_counts() const { return counts_; }
  bool conforming() const { return counts_.hanging == 0; }
  // Vertices of final_mesh(FaceClosure::Quads): 2 (V + F) - chi of the leaves with hanging nodes, V without any.
  std::int64_t closed_vertex_count() const { return conforming() ? counts_.vertices : 2 * (counts_.vertices + counts_.faces) - counts_.euler; }

  // --- irregular operations ---------------------------------------------------------------------------------------------------------------
  struct Operation {
    Repatch repatch;           // as applied, with `sides` complete
    std::vector<int> roots;    // nodes inserted
    std::vector<int> depends;  // earlier operations that must be enabled with it
    int first_vertex = 0;      // index of its first Free vertex
    bool enabled = true;
  };
  int operation_count() const { return static_cast<int>(operations_.size()); }
  const Operation& operation(int i) const { return operations_[i]; }
  // Applies and enables an operation, all earlier ones that it depends on being enabled. Returns an empty string, or the reason for refusing it,
  // and then nothing has changed. The result is not balanced (the new root quads are leaves): call balance().
  std::string apply(const Repatch& repatch);
  // Selects the operations under which nodes are active. Returns an empty string, or the reason for refusing it (a dependency is missing, the
  // mesh would not be a 2-manifold), and then nothing has changed. Quads that a disabled operation removes are leaves again, or go on where
  // they were refined; not balanced.
  std::string set_enabled(const std::vector<bool>& enabled);
  std::vector<bool> enabled() const;

  // --- extraction ---------------------------------------------------------------------------------------------------------------------------
  FaceClosure closure() const { return closure_; }
  void set_closure(FaceClosure closure) { closure_ = closure; }
  // The connectivity of the leaves up to level `cap` (in a uniform hierarchy: of all nodes of that level), closed. LevelKind::M leaves out the
  // operations of level `cap`. `places`: where each vertex lies, if that is asked for. 0 <= cap; max_level + 1: all leaves.
  LevelMesh connectivity(int cap, LevelKind kind, FaceClosure closure, std::vector<PlaceInFace>* places = nullptr) const;

 protected:
  friend QuadForest grow(QuadForest base, Growth& growth, int most_nodes);

  struct Node {
    std::array<HalfEdge, 4> half{-1, -1, -1, -1};
    std::int32_t parent = -1, child = -1, root = -1;
    std::int32_t operation = -1;  // root: that made it; else: that removes it
    std::int32_t map = -1;
    std::int8_t level = 0;
    bool active = true;
  };
  struct Edge {
    VertexId from, to;
    std::int32_t parent = -1, child = -1;  // children are child (from .. midpoint) and child + 1 (midpoint .. to)
    std::int32_t origin = -1;              // node that made it, 4 * node + side (root) or 4 * node + inner edge
    std::int8_t level = 0;
    bool sharp = false;
    bool on_mirror = false;
  };
  struct FreeVertex {
    std::int32_t origin = -1;  // 4 * node + corner of a root quad
    std::int8_t level = 0;
  };
  // The sector of a vertex that lies to the left of a half-edge leaving it, in the mesh of leaves up to level `cap`; `next` is the half-edge that
  // bounds the sector on its other side. node = -1: nothing there (boundary). corner = -1: the vertex lies inside a side of the node.
  struct Sector {
    int node = -1, corner = -1;
    HalfEdge next = -1;
  };

  HalfEdge half_child(HalfEdge h, int part) const {  // part 0 starts where h does
    return 2 * (edges_[h >> 1].child + (part ^ (h & 1))) + (h & 1);
  }
  HalfEdge half_parent(HalfEdge h) const { return edges_[h >> 1].parent < 0 ? -1 : 2 * edges_[h >> 1].parent + (h & 1); }
  int part_of_parent(HalfEdge h) const { return ((h >> 1) - edges_[edges_[h >> 1].parent].child) ^ (h & 1); }
  HalfEdge descend(HalfEdge h, int cap) const;
  Sector sector_left(HalfEdge leaving, int cap) const;   // counter-clockwise
  Sector sector_right(HalfEdge leaving, int cap) const;  // clockwise
  SideLink holder_or_coarser(HalfEdge h) const;
  bool finer(HalfEdge h) const;
  std::vector<int> with_parts(int edge) const;
  int add_edge(VertexId from, VertexId to, int level, int origin);
  void split_edge(int edge);
  int split(int node);
  int instantiate(int node);
  void activate();
  void count_leaves();
  int deepest_level() const;
  template <class Visit>
  void visit_corner(int node, int corner, const Visit& visit) const;
  std::string complete_sides(Repatch& repatch) const;
  std::string validate(const Repatch& repatch) const;
  std::vector<int> dependencies(const Repatch& repatch) const;
  void append(Operation op);
  void deactivate(int node);
  std::string find_fan_defect(int cap) const;
  std::string find_double_edge(const Operation& operation) const;
  std::string find_double_edge(int least_level) const;
  std::string find_choice_defect() const;
  // Nodes in the order of the trees; operations of the level itself are left out for M.
  std::vector<int> level_faces(int cap, LevelKind kind) const;
  // The faces of a level and the loops of their corners (leaf_polygons.h).
  struct Polygons;
  Polygons polygons(int cap, LevelKind kind) const;
  Polygons polygons(std::vector<int> faces) const;

  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  std::vector<std::int32_t> holder_;  // per half-edge: 4 * node + side of the active node that has it, -1
  std::vector<FreeVertex> free_;
  std::vector<Operation> operations_;
  std::map<HalfEdge, int> freed_by_;  // half-edges of removed quads -> operation
  FaceClosure closure_ = FaceClosure::Quads;
  int base_count_ = 0, base_vertices_ = 0;
  bool has_sharp_sides_ = false;
  LeafCounts counts_;
};

// Calls visit(leaf) for the leaves around a corner, the ones clockwise of the start in reverse order after the others.
template <class Visit>
void QuadForest::visit_corner(int node, int corner, const Visit& visit) const {
  const HalfEdge start = descend(nodes_[node].half[corner], max_level + 1);
  HalfEdge h = start;
  while (true) {
    const Sector sector = sector_left(h, max_level + 1);
    if (sector.node < 0) break;
    visit(sector.node, false);
    h = sector.next;
    if (h == start) return;
  }
  h = start;
  while (true) {
    const Sector sector = sector_right(h, max_level + 1);
    if (sector.node < 0) return;
    visit(sector.node, true);
    h = sector.next;
  }
}

}  // namespace hybrid_mesh
