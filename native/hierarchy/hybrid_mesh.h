// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "parameterization/patch_map.h"
#include "surface/polygon_soup.h"

namespace hybrid_mesh {

// What becomes of a mesh of leaves that has hanging nodes. A mesh without any is never changed.
enum class FaceClosure {
  Quads,       // every leaf is split once at its centre and at its edges' midpoints: pure quads, no cracks
  Transition,  // leaves stay whole, hanging nodes become corners: n-gons, no cracks
  Triangles    // the n-gons of Transition with more than four corners are triangulated
};

// N^j is level j after its irregular operations, M^j before them.
enum class LevelKind { N, M };

// A vertex is named by what made it, so that every quad that asks for it gets the same name: a corner of the base or an inner vertex of
// an operation (Free), the midpoint of an edge, or the centre of a node.
struct VertexId {
  enum class Kind { Free = 0, Edge = 1, Node = 2 };
  std::int32_t code = -1;
  VertexId() = default;
  VertexId(Kind kind, int index) : code(static_cast<std::int32_t>((static_cast<std::uint32_t>(index) << 2) | static_cast<std::uint32_t>(kind))) {}
  Kind kind() const { return static_cast<Kind>(code & 3); }
  int index() const { return code >> 2; }
  bool valid() const { return code >= 0; }
  friend bool operator==(VertexId a, VertexId b) { return a.code == b.code; }
  friend bool operator!=(VertexId a, VertexId b) { return a.code != b.code; }
  friend bool operator<(VertexId a, VertexId b) { return a.code < b.code; }
};

// A side of a node; side i runs from corner i to corner i + 1, counter-clockwise. node = -1: none (boundary).
struct SideLink {
  int node = -1;
  int side = 0;
  bool valid() const { return node >= 0; }
  friend bool operator==(const SideLink&, const SideLink&) = default;
};

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

// A directed edge of some level: 2 * edge + (1 if it runs backwards). The node that has it as a side lies to its left; h ^ 1 is its twin.
using HalfEdge = std::int32_t;

// An irregular operation: quads of one level are removed and new root quads put in their place.
struct Repatch {
  // One side of a new quad.
  struct Side {
    enum class Kind {
      Patch,  // glued to side `side` of new quad `quad`
      Outer,  // takes the half-edge `half`, which a removed quad holds or which is free (an open boundary)
      Open    // a boundary edge of the new mesh
    };
    Kind kind = Kind::Open;
    int quad = -1, side = 0;
    HalfEdge half = -1;
  };
  int level = 0;
  std::vector<int> removed;                // active nodes of `level`, not roots; may be empty
  int new_vertices = 0;                    // inner vertices that the operation makes
  std::vector<std::array<int, 4>> quads;   // corners, counter-clockwise: >= 0 entry of `boundary`, < 0 new vertex -1 - c
  std::vector<VertexId> boundary;          // existing vertices that the quads use
  std::vector<std::array<Side, 4>> sides;  // #quads; empty: derived from corner pairs
  std::string kind = "repatch";            // for reports: "add_cubes", "connect", "open_boundary", ...
};

class HybridMesh {
 public:
  static constexpr int max_level = 24;

  HybridMesh() = default;

  // --- base -----------------------------------------------------------------------------------------------------------------------
  // Quads with corners counter-clockwise and, for each side, the side it is glued to. Quads may share several edges or all four corners,
  // and a quad may be glued to itself. Throws Error{InvalidInput} if links are not symmetric, do not run between the same corners in opposite
  // directions, a vertex is unused or has more than one fan.
  static HybridMesh from_base(int vertices, const std::vector<std::array<int, 4>>& quads, const std::vector<std::array<SideLink, 4>>& neighbours);
  // Neighbours derived from pairs of corners. Throws also if two sides run between the same corners in the same direction.
  static HybridMesh from_base(int vertices, const std::vector<std::array<int, 4>>& quads);

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
  void set_sharp(int base_quad, int side);
  void take_sharp_sides(const HybridMesh& other);  // of a hierarchy with the same base
  bool has_sharp_sides() const;
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
  // A canonical place of the vertex in a map (see MapLocation).
  MapLocation locate(VertexId vertex) const;
  PatchSample sample(VertexId vertex) const { return sample(locate(vertex)); }
  // Throws Error{InvalidInput} if the node there has no map.
  PatchSample sample(const MapLocation& location) const;

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
  FaceClosure closure() const { return closure_; }
  void set_closure(FaceClosure closure) { closure_ = closure; }
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
  struct MapSlot {
    explicit MapSlot(std::shared_ptr<const PatchMap> m) : map(std::move(m)), sampler(*map) {}
    std::shared_ptr<const PatchMap> map;
    PatchSampler sampler;
  };
  // Sorted by vertex.
  using Positions = std::vector<std::pair<VertexId, Vec3>>;

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
  // The faces of a level and the loops of their corners (leaf_polygons.h).
  struct Polygons;
  Polygons polygons(int cap, LevelKind kind) const;
  QuadMesh close(const Polygons& polygons, FaceClosure closure, const Positions* positions) const;
  std::size_t vertex_slot(VertexId vertex) const {
    const std::size_t i = vertex.index();
    if (vertex.kind() == VertexId::Kind::Free) return i;
    return vertex.kind() == VertexId::Kind::Edge ? free_.size() + i : free_.size() + edges_.size() + i;
  }
  std::size_t vertex_slots() const { return free_.size() + edges_.size() + nodes_.size(); }

  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  std::vector<std::int32_t> holder_;  // per half-edge: 4 * node + side of the active node that has it, -1
  std::vector<FreeVertex> free_;
  std::vector<Operation> operations_;
  std::map<HalfEdge, int> freed_by_;  // half-edges of removed quads -> operation
  std::vector<std::shared_ptr<const MapSlot>> maps_;
  std::vector<Positions> level_positions_;
  Positions final_positions_;
  FaceClosure closure_ = FaceClosure::Quads;
  int base_count_ = 0, base_vertices_ = 0;
  LeafCounts counts_;
};

// Every broken invariant in words; empty if there is none. Checks links, levels, manifoldness of the leaves and of every level, balance, operations,
// counts.
std::vector<std::string> find_defects(const HybridMesh& mesh);

// Calls visit(leaf) for the leaves around a corner, the ones clockwise of the start in reverse order after the others.
template <class Visit>
void HybridMesh::visit_corner(int node, int corner, const Visit& visit) const {
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
