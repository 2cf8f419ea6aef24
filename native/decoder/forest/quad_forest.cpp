// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid Meshes: Multiresolution using Regular and Irregular Refinement, 2002, section 2.
//
// The links between quads are edges that both sides share: an edge names its two children and the active node on each of its sides. A root quad
// keeps its neighbours that way, and so does a removed quad: the quad put in its place holds the same half-edge. Neighbours of any node are found
// by climbing from its side's half-edge to the nearest one that is held.
#include "decoder/forest/quad_forest.h"

#include <algorithm>
#include <map>

#include "decoder/error.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

std::string side_name(std::size_t quad, int side) { return "side " + std::to_string(side) + " of quad " + std::to_string(quad); }

}  // namespace

// --- base --------------------------------------------------------------------------------------------------------------------------------------

QuadForest QuadForest::from_base(int vertices, const std::vector<std::array<int, 4>>& quads) {
  std::map<std::pair<int, int>, SideLink> sides;
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (int s = 0; s < 4; ++s)
      if (!sides.try_emplace({quads[q][s], quads[q][(s + 1) % 4]}, SideLink{static_cast<int>(q), s}).second)
        refuse("two sides of base quads run between the same corners in the same direction (" + side_name(q, s) + "): neighbours must be given");
  std::vector<std::array<SideLink, 4>> neighbours(quads.size());
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      const auto found = sides.find({quads[q][(s + 1) % 4], quads[q][s]});
      if (found != sides.end()) neighbours[q][s] = found->second;
    }
  return from_base(vertices, quads, neighbours);
}

QuadForest QuadForest::from_base(int vertices, const std::vector<std::array<int, 4>>& quads, const std::vector<std::array<SideLink, 4>>& neighbours) {
  const int count = static_cast<int>(quads.size());
  if (count == 0) refuse("a base domain without quads");
  if (neighbours.size() != quads.size()) refuse("neighbours and quads of the base domain differ in number");
  QuadForest mesh;
  mesh.base_count_ = count;
  mesh.base_vertices_ = vertices;
  mesh.nodes_.resize(count);
  mesh.free_.resize(std::max(vertices, 0));
  for (int q = 0; q < count; ++q)
    for (int s = 0; s < 4; ++s) {
      const int c = quads[q][s];
      if (c < 0 || c >= vertices) refuse("a base quad with a corner out of range");
      if (mesh.free_[c].origin < 0) mesh.free_[c].origin = 4 * q + s;
    }
  for (const FreeVertex& v : mesh.free_)
    if (v.origin < 0) refuse("a base vertex without a quad");
  for (int q = 0; q < count; ++q) {
    Node& node = mesh.nodes_[q];
    node.root = q;
    for (int s = 0; s < 4; ++s) {
      const SideLink link = neighbours[q][s];
      const int a = quads[q][s], b = quads[q][(s + 1) % 4];
      if (link.valid()) {
        if (link.node >= count || link.side < 0 || link.side > 3) refuse("a neighbour out of range at " + side_name(q, s));
        if (link == SideLink{q, s} || neighbours[link.node][link.side] != SideLink{q, s})
          refuse("a neighbour that is not mutual at " + side_name(q, s));
        if (quads[link.node][link.side] != b || quads[link.node][(link.side + 1) % 4] != a)
          refuse("neighbours that do not share corners in opposite directions at " + side_name(q, s));
      }
      if (node.half[s] >= 0) continue;
      const int e = mesh.add_edge(VertexId(VertexId::Kind::Free, a), VertexId(VertexId::Kind::Free, b), 0, 4 * q + s);
      node.half[s] = 2 * e;
      if (link.valid()) mesh.nodes_[link.node].half[link.side] = 2 * e + 1;
    }
  }
  mesh.activate();
  const std::string defect = mesh.find_fan_defect(0);
  if (!defect.empty()) refuse("the base domain is no 2-manifold: " + defect);
  return mesh;
}

int QuadForest::add_edge(VertexId from, VertexId to, int level, int origin) {
  Edge edge;
  edge.from = from;
  edge.to = to;
  edge.level = static_cast<std::int8_t>(level);
  edge.origin = origin;
  edges_.push_back(edge);
  holder_.insert(holder_.end(), 2, -1);
  return static_cast<int>(edges_.size()) - 1;
}

// --- the forest ----------------------------------------------------------------------------------------------------------------------------------

std::vector<int> QuadForest::roots() const {
  std::vector<int> result;
  for (int q = 0; q < base_count_; ++q) result.push_back(q);
  for (const Operation& op : operations_)
    if (op.enabled) result.insert(result.end(), op.roots.begin(), op.roots.end());
  return result;
}

std::vector<int> QuadForest::leaves() const {
  std::vector<int> result, stack = roots();
  std::reverse(stack.begin(), stack.end());
  while (!stack.empty()) {
    const int n = stack.back();
    stack.pop_back();
    if (!nodes_[n].active) continue;
    if (nodes_[n].child < 0) {
      result.push_back(n);
    } else {
      for (int k = 3; k >= 0; --k) stack.push_back(nodes_[n].child + k);
    }
  }
  return result;
}

int QuadForest::depth() const {
  int depth = 0;
  for (const Node& node : nodes_)
    if (node.active) depth = std::max(depth, static_cast<int>(node.level));
  return depth;
}

// An edge and all that it is split into.
std::vector<int> QuadForest::with_parts(int edge) const {
  std::vector<int> parts{edge};
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (const int child = edges_[parts[k]].child; child >= 0) parts.insert(parts.end(), {child, child + 1});
  return parts;
}

void QuadForest::set_sharp(int base_quad, int side) {
  has_sharp_sides_ = true;
  for (const int e : with_parts(half_edge(base_quad, side) >> 1)) edges_[e].sharp = true;
}

void QuadForest::set_on_mirror(int root, int side) {
  for (const int e : with_parts(half_edge(root, side) >> 1)) edges_[e].on_mirror = true;
}

void QuadForest::take_sharp_sides(const QuadForest& other) {
  for (int q = 0; q < base_count_; ++q)
    for (int side = 0; side < 4; ++side)
      if (other.is_sharp(q, side)) set_sharp(q, side);
}

// The level from which on the meshes of all levels are that of the leaves: one below depth() where the deepest refined quads have lost all their
// children.
int QuadForest::deepest_level() const {
  int deepest = 0;
  for (const Node& node : nodes_)
    if (node.active) deepest = std::max(deepest, node.level + (node.child >= 0));
  return deepest;
}

QuadForest::Square QuadForest::square_in(int node, int ancestor) const {
  Square square;
  while (node != ancestor) {
    const int up = nodes_[node].parent;
    const int k = node - nodes_[up].child;
    square.u = 0.5 * (square.u + (k == 1 || k == 2 ? 1 : 0));
    square.v = 0.5 * (square.v + (k >= 2 ? 1 : 0));
    square.width *= 0.5;
    node = up;
  }
  return square;
}

// --- vertices ------------------------------------------------------------------------------------------------------------------------------------

int QuadForest::birth_level(VertexId vertex) const {
  switch (vertex.kind()) {
    case VertexId::Kind::Free:
      return free_[vertex.index()].level;
    case VertexId::Kind::Edge:
      return edges_[vertex.index()].level + 1;
    default:
      return nodes_[vertex.index()].level + 1;
  }
}

// --- regular refinement ----------------------------------------------------------------------------------------------------------------------------

void QuadForest::split_edge(int e) {
  if (edges_[e].child >= 0) return;
  const VertexId middle(VertexId::Kind::Edge, e);
  const VertexId from = edges_[e].from, to = edges_[e].to;
  const int level = edges_[e].level + 1;
  const int first = add_edge(from, middle, level, edges_[e].origin);
  add_edge(middle, to, level, edges_[e].origin);
  edges_[e].child = first;
  edges_[first].parent = edges_[first + 1].parent = e;
  edges_[first].sharp = edges_[first + 1].sharp = edges_[e].sharp;
  edges_[first].on_mirror = edges_[first + 1].on_mirror = edges_[e].on_mirror;
}

// Makes children, edges and vertices, but says nothing to the neighbours.
int QuadForest::split(int n) {
  if (nodes_[n].level >= max_level) throw Error(ErrorCode::Unsupported, "more than " + std::to_string(max_level) + " levels");
  if (nodes_.size() > (1u << 28)) throw Error(ErrorCode::Unsupported, "too many quads in one hierarchy");
  const std::array<HalfEdge, 4> half = nodes_[n].half;
  const int level = nodes_[n].level + 1;
  for (HalfEdge h : half) split_edge(h >> 1);
  const VertexId centre(VertexId::Kind::Node, n);
  std::array<HalfEdge, 4> inner;  // from the middle of side k to the centre
  for (int k = 0; k < 4; ++k) inner[k] = 2 * add_edge(VertexId(VertexId::Kind::Edge, half[k] >> 1), centre, level, 4 * n + k);
  const int first = static_cast<int>(nodes_.size());
  Node child;
  child.parent = n;
  child.root = nodes_[n].root;
  child.level = static_cast<std::int8_t>(level);
  child.active = nodes_[n].active;
  for (int k = 0; k < 4; ++k) {
    const int before = (k + 3) % 4;
    child.half[k] = half_child(half[k], 0);
    child.half[(k + 1) % 4] = inner[k];
    child.half[(k + 2) % 4] = inner[before] ^ 1;
    child.half[before] = half_child(half[before], 1);
    nodes_.push_back(child);
  }
  nodes_[n].child = first;
  return first;
}

int QuadForest::refine(int n) {
  if (nodes_[n].child >= 0) return nodes_[n].child;
  if (nodes_[n].active && nodes_[n].level < max_level) {
    counts_.faces += 3;
    counts_.vertices += 1;
    for (int s = 0; s < 4; ++s) {
      const HalfEdge h = nodes_[n].half[s], across = h ^ 1;
      const SideLink other = holder_or_coarser(across);
      if (other.node == n) {  // glued to itself: the midpoint is made once
        counts_.vertices += h < across;
        continue;
      }
      if (has_finer_neighbour(n, s)) {
        counts_.hanging -= 1;
      } else {
        counts_.vertices += 1;
        counts_.hanging += other.valid() && nodes_[other.node].child < 0;
      }
    }
  }
  return instantiate(n);
}

// Refines a node that is not, and leaves the counts to the caller.
int QuadForest::instantiate(int n) {
  const int first = split(n);
  if (nodes_[n].active)
    for (int c = first; c < first + 4; ++c)
      for (int s = 0; s < 4; ++s) holder_[nodes_[c].half[s]] = 4 * c + s;
  return first;
}

void QuadForest::reserve_levels(int level) {
  std::size_t quads = nodes_.size(), edges = edges_.size(), all_quads = quads, all_edges = edges;
  for (int j = 0; j < level; ++j) {
    edges = 2 * edges + 4 * quads;
    quads *= 4;
    all_quads += quads;
    all_edges += edges;
  }
  nodes_.reserve(all_quads);
  edges_.reserve(all_edges);
  holder_.reserve(2 * all_edges);
}

void QuadForest::refine_balanced(int leaf, std::vector<int>* refined) {
  std::vector<int> stack{leaf};
  while (!stack.empty()) {
    const int n = stack.back();
    if (!is_leaf(n)) {
      stack.pop_back();
      continue;
    }
    const int level = nodes_[n].level;
    if (level >= max_level) throw Error(ErrorCode::Unsupported, "more than " + std::to_string(max_level) + " levels");
    const std::size_t before = stack.size();
    for (int c = 0; c < 4; ++c)
      visit_corner(n, c, [&](int other, bool) {
        if (nodes_[other].level < level) stack.push_back(other);
      });
    if (stack.size() > before) continue;
    stack.pop_back();
    refine(n);
    if (refined) refined->push_back(n);
    for (int s = 0; s < 4; ++s) {
      const SideLink other = neighbour(n, s);
      if (!other.valid() || !is_leaf(other.node)) continue;
      int finer_sides = 0;
      for (int t = 0; t < 4; ++t) finer_sides += has_finer_neighbour(other.node, t);
      if (finer_sides >= 3 || is_sharp(n, s)) stack.push_back(other.node);
    }
  }
}

void QuadForest::refine_uniform(int levels) {
  if (levels > max_level) throw Error(ErrorCode::Unsupported, "more than " + std::to_string(max_level) + " levels");
  // Children come after their parents, so one pass does.
  for (int n = 0; n < node_count(); ++n)
    if (is_leaf(n) && nodes_[n].level < levels) refine(n);
}

void QuadForest::balance(std::vector<int>* refined) {
  bool changed = true;
  std::vector<int> coarse;
  while (changed) {
    changed = false;
    for (int n : leaves()) {
      if (!is_leaf(n)) continue;
      coarse.clear();
      int finer_sides = 0;
      bool coarse_at_feature = false;
      for (int s = 0; s < 4; ++s) {
        finer_sides += has_finer_neighbour(n, s);
        coarse_at_feature |= is_sharp(n, s) && has_finer_neighbour(n, s);
        // Looked at from the finer leaf: its corners show every coarser one, also where they lie inside that one's side.
        visit_corner(n, s, [&](int other, bool) {
          if (nodes_[other].level + 1 < nodes_[n].level) coarse.push_back(other);
        });
      }
      if (finer_sides >= 3 || coarse_at_feature) coarse.push_back(n);
      for (int leaf : coarse) refine_balanced(leaf, refined);
      changed |= !coarse.empty();
    }
  }
  count_leaves();
}

// Finds the active nodes and what each half-edge is held by, from the enabled operations.
void QuadForest::activate() {
  std::fill(holder_.begin(), holder_.end(), -1);
  for (Node& node : nodes_) node.active = false;
  std::vector<int> stack = roots();
  while (!stack.empty()) {
    const int n = stack.back();
    stack.pop_back();
    Node& node = nodes_[n];
    const int removed = removed_by(n);
    if (removed >= 0 && operations_[removed].enabled) continue;
    node.active = true;
    for (int s = 0; s < 4; ++s) holder_[node.half[s]] = 4 * n + s;
    if (node.child >= 0)
      for (int k = 0; k < 4; ++k) stack.push_back(node.child + k);
  }
  count_leaves();
}

}  // namespace hybrid_mesh
