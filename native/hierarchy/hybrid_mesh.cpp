// SPDX-License-Identifier: GPL-3.0-or-later
// Based on: Guskov, Khodakovsky, Schroeder, Sweldens, Hybrid Meshes: Multiresolution using Regular and Irregular Refinement, 2002, section 2.
//
// The links between quads are edges that both sides share: an edge names its two children and the active node on each of its sides. A root quad
// keeps its neighbours that way, and so does a removed quad: the quad put in its place holds the same half-edge. Neighbours of any node are found
// by climbing from its side's half-edge to the nearest one that is held.
#include "hierarchy/hybrid_mesh.h"

#include <algorithm>
#include <map>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

std::string side_name(std::size_t quad, int side) { return "side " + std::to_string(side) + " of quad " + std::to_string(quad); }

}  // namespace

PolygonSoup to_soup(const QuadMesh& mesh) {
  PolygonSoup soup;
  soup.points = mesh.points;
  soup.offsets = mesh.offsets;
  soup.indices = mesh.indices;
  return soup;
}

// --- base --------------------------------------------------------------------------------------------------------------------------------------

HybridMesh HybridMesh::from_base(int vertices, const std::vector<std::array<int, 4>>& quads) {
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

HybridMesh HybridMesh::from_base(int vertices, const std::vector<std::array<int, 4>>& quads, const std::vector<std::array<SideLink, 4>>& neighbours) {
  const int count = static_cast<int>(quads.size());
  if (count == 0) refuse("a base domain without quads");
  if (neighbours.size() != quads.size()) refuse("neighbours and quads of the base domain differ in number");
  HybridMesh mesh;
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

int HybridMesh::add_edge(VertexId from, VertexId to, int level, int origin) {
  Edge edge;
  edge.from = from;
  edge.to = to;
  edge.level = static_cast<std::int8_t>(level);
  edge.origin = origin;
  edges_.push_back(edge);
  holder_.resize(2 * edges_.size(), -1);
  return static_cast<int>(edges_.size()) - 1;
}

// --- the forest ----------------------------------------------------------------------------------------------------------------------------------

std::vector<int> HybridMesh::roots() const {
  std::vector<int> result;
  for (int q = 0; q < base_count_; ++q) result.push_back(q);
  for (const Operation& op : operations_)
    if (op.enabled) result.insert(result.end(), op.roots.begin(), op.roots.end());
  return result;
}

std::vector<int> HybridMesh::leaves() const {
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

int HybridMesh::depth() const {
  int depth = 0;
  for (const Node& node : nodes_)
    if (node.active) depth = std::max(depth, static_cast<int>(node.level));
  return depth;
}

// The level from which on the meshes of all levels are that of the leaves: one below depth() where the deepest refined quads have lost all their
// children.
int HybridMesh::deepest_level() const {
  int deepest = 0;
  for (const Node& node : nodes_)
    if (node.active) deepest = std::max(deepest, node.level + (node.child >= 0));
  return deepest;
}

HybridMesh::Square HybridMesh::square_in(int node, int ancestor) const {
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

int HybridMesh::birth_level(VertexId vertex) const {
  switch (vertex.kind()) {
    case VertexId::Kind::Free:
      return free_[vertex.index()].level;
    case VertexId::Kind::Edge:
      return edges_[vertex.index()].level + 1;
    default:
      return nodes_[vertex.index()].level + 1;
  }
}

MapLocation HybridMesh::locate(VertexId vertex) const {
  int node = -1;
  double u = 0, v = 0;  // in `node`
  const auto on_side = [&](int side, double t) {
    static constexpr double corner_u[4] = {0, 1, 1, 0}, corner_v[4] = {0, 0, 1, 1};
    u = corner_u[side] + t * (corner_u[(side + 1) % 4] - corner_u[side]);
    v = corner_v[side] + t * (corner_v[(side + 1) % 4] - corner_v[side]);
  };
  if (vertex.kind() == VertexId::Kind::Node) {
    node = vertex.index();
    u = v = 0.5;
  } else if (vertex.kind() == VertexId::Kind::Free) {
    node = free_[vertex.index()].origin / 4;
    on_side(free_[vertex.index()].origin % 4, 0);
  } else {
    int e = vertex.index();
    double t = 0.5;  // from the edge's start
    while (true) {
      const int holder = holder_[2 * e] >= 0 ? holder_[2 * e] : holder_[2 * e + 1];
      if (holder >= 0) {
        node = holder / 4;
        on_side(holder % 4, holder_[2 * e] >= 0 ? t : 1 - t);
        break;
      }
      const int up = edges_[e].parent;
      if (up < 0) {  // of a part that is switched off
        node = edges_[e].origin / 4;
        const int k = edges_[e].origin % 4;
        on_side(k, nodes_[node].level == edges_[e].level ? t : 0.5);
        if (nodes_[node].level != edges_[e].level) {  // inner edge: from the middle of side k to the centre
          u += t * (0.5 - u);
          v += t * (0.5 - v);
        }
        break;
      }
      t = 0.5 * (t + (e - edges_[up].child));
      e = up;
    }
  }
  int owner = map_owner(node);
  if (owner < 0) owner = nodes_[node].root;
  const Square square = square_in(node, owner);
  return {owner, square.u + square.width * u, square.v + square.width * v};
}

PatchSample HybridMesh::sample(const MapLocation& location) const {
  const PatchSampler* sampler = location.node < 0 ? nullptr : this->sampler(location.node);
  if (!sampler) refuse("no map to sample");
  return (*sampler)(location.u, location.v);
}

// --- neighbours ----------------------------------------------------------------------------------------------------------------------------------

// The active node that has a half-edge as a side, or the coarser leaf that has it as a part of a side.
SideLink HybridMesh::holder_or_coarser(HalfEdge h) const {
  if (holder_[h] >= 0) return {holder_[h] / 4, holder_[h] % 4};
  for (h = half_parent(h); h >= 0; h = half_parent(h)) {
    const int k = holder_[h];
    if (k < 0) continue;
    // A refined node whose descendants do not hold the half-edge has lost them there to an operation.
    if (nodes_[k / 4].child >= 0) break;
    return {k / 4, k % 4};
  }
  return {};
}

SideLink HybridMesh::neighbour(int node, int side) const { return holder_or_coarser(nodes_[node].half[side] ^ 1); }

SideLink HybridMesh::removed_neighbour(int node, int side) const {
  const int op = removed_by(node);
  if (op < 0) return {};
  const HalfEdge h = nodes_[node].half[side];
  for (int root : operations_[op].roots)
    for (int s = 0; s < 4; ++s)
      if (nodes_[root].half[s] == h) return {root, s};
  return {};
}

std::vector<SideLink> HybridMesh::leaf_neighbours(int node, int side) const {
  std::vector<SideLink> result;
  const HalfEdge across = nodes_[node].half[side] ^ 1;
  const SideLink coarse = holder_or_coarser(across);
  if (coarse.valid() && nodes_[coarse.node].child < 0) return {coarse};
  // Parts in the direction of the twin; reversed at the end.
  std::vector<HalfEdge> stack{across};
  while (!stack.empty()) {
    const HalfEdge h = stack.back();
    stack.pop_back();
    if (holder_[h] >= 0 && nodes_[holder_[h] / 4].child < 0) {
      result.push_back({holder_[h] / 4, holder_[h] % 4});
    } else if (edges_[h >> 1].child >= 0) {
      stack.push_back(half_child(h, 0));
      stack.push_back(half_child(h, 1));
    }
  }
  return result;
}

// Whether an active node holds a part of the half-edge.
bool HybridMesh::finer(HalfEdge h) const {
  if (edges_[h >> 1].child < 0) return false;
  for (int part = 0; part < 2; ++part) {
    const HalfEdge c = half_child(h, part);
    if (holder_[c] >= 0 || finer(c)) return true;
  }
  return false;
}

bool HybridMesh::has_finer_neighbour(int node, int side) const {
  // A refined node across may have lost all its quads there to an operation.
  std::vector<HalfEdge> stack{nodes_[node].half[side] ^ 1};
  while (!stack.empty()) {
    const HalfEdge h = stack.back();
    stack.pop_back();
    if (edges_[h >> 1].child < 0) continue;
    for (int part = 0; part < 2; ++part) {
      const HalfEdge c = half_child(h, part);
      if (holder_[c] >= 0 && nodes_[holder_[c] / 4].child < 0) return true;
      stack.push_back(c);
    }
  }
  return false;
}

HalfEdge HybridMesh::descend(HalfEdge h, int cap) const {
  while (edges_[h >> 1].child >= 0 && edges_[h >> 1].level < cap) h = half_child(h, 0);
  return h;
}

HybridMesh::Sector HybridMesh::sector_left(HalfEdge leaving, int cap) const {
  Sector sector;
  HalfEdge bent = -1;  // set once the vertex lies inside the side climbed to
  for (HalfEdge h = leaving; h >= 0;) {
    const int k = holder_[h];
    if (k >= 0) {
      const Node& node = nodes_[k / 4];
      if (node.level < cap && node.child >= 0) return {};
      sector.node = k / 4;
      sector.corner = bent < 0 ? k % 4 : -1;
      sector.next = descend(bent < 0 ? node.half[(k + 3) % 4] ^ 1 : bent, cap);
      return sector;
    }
    const HalfEdge up = half_parent(h);
    if (up >= 0 && bent < 0 && part_of_parent(h) == 1) bent = half_child(up, 0) ^ 1;
    h = up;
  }
  return {};
}

HybridMesh::Sector HybridMesh::sector_right(HalfEdge leaving, int cap) const {
  Sector sector;
  HalfEdge bent = -1;
  for (HalfEdge h = leaving ^ 1; h >= 0;) {
    const int k = holder_[h];
    if (k >= 0) {
      const Node& node = nodes_[k / 4];
      if (node.level < cap && node.child >= 0) return {};
      sector.node = k / 4;
      sector.corner = bent < 0 ? (k + 1) % 4 : -1;
      sector.next = descend(bent < 0 ? node.half[(k + 1) % 4] : bent, cap);
      return sector;
    }
    const HalfEdge up = half_parent(h);
    if (up >= 0 && bent < 0 && part_of_parent(h) == 0) bent = half_child(up, 1);
    h = up;
  }
  return {};
}

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

std::vector<int> HybridMesh::leaves_at_corner(int node, int corner) const {
  std::vector<int> after, before;
  const auto visit = [&](int leaf, bool clockwise) { (clockwise ? before : after).push_back(leaf); };
  visit_corner(node, corner, visit);
  if (after.empty() && before.empty()) {
    // The quads on both sides of a refined node's side were removed; what is left around the vertex has other edges.
    const VertexId vertex = this->corner(node, corner);
    for (int leaf : leaves())
      for (int i = 0; i < 4 && after.empty(); ++i)
        if (this->corner(leaf, i) == vertex) visit_corner(leaf, i, visit);
  }
  std::reverse(before.begin(), before.end());
  before.insert(before.end(), after.begin(), after.end());
  std::vector<int> result;
  for (int leaf : before)
    if (std::find(result.begin(), result.end(), leaf) == result.end()) result.push_back(leaf);
  return result;
}

// --- regular refinement ----------------------------------------------------------------------------------------------------------------------------

void HybridMesh::split_edge(int e) {
  if (edges_[e].child >= 0) return;
  const VertexId middle(VertexId::Kind::Edge, e);
  const VertexId from = edges_[e].from, to = edges_[e].to;
  const int level = edges_[e].level + 1;
  const int first = add_edge(from, middle, level, edges_[e].origin);
  add_edge(middle, to, level, edges_[e].origin);
  edges_[e].child = first;
  edges_[first].parent = edges_[first + 1].parent = e;
}

// Makes children, edges and vertices, but says nothing to the neighbours.
int HybridMesh::split(int n) {
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

int HybridMesh::refine(int n) {
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
  const int first = split(n);
  if (nodes_[n].active)
    for (int c = first; c < first + 4; ++c)
      for (int s = 0; s < 4; ++s) holder_[nodes_[c].half[s]] = 4 * c + s;
  return first;
}

void HybridMesh::refine_balanced(int leaf, std::vector<int>* refined) {
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
      if (finer_sides >= 3) stack.push_back(other.node);
    }
  }
}

void HybridMesh::refine_uniform(int levels) {
  if (levels > max_level) throw Error(ErrorCode::Unsupported, "more than " + std::to_string(max_level) + " levels");
  // Children come after their parents, so one pass does.
  for (int n = 0; n < node_count(); ++n)
    if (is_leaf(n) && nodes_[n].level < levels) refine(n);
}

void HybridMesh::balance(std::vector<int>* refined) {
  bool changed = true;
  std::vector<int> coarse;
  while (changed) {
    changed = false;
    for (int n : leaves()) {
      if (!is_leaf(n)) continue;
      coarse.clear();
      int finer_sides = 0;
      for (int s = 0; s < 4; ++s) {
        finer_sides += has_finer_neighbour(n, s);
        // Looked at from the finer leaf: its corners show every coarser one, also where they lie inside that one's side.
        visit_corner(n, s, [&](int other, bool) {
          if (nodes_[other].level + 1 < nodes_[n].level) coarse.push_back(other);
        });
      }
      if (finer_sides >= 3) coarse.push_back(n);
      for (int leaf : coarse) refine_balanced(leaf, refined);
      changed |= !coarse.empty();
    }
  }
  count_leaves();
}

// Finds the active nodes and what each half-edge is held by, from the enabled operations.
void HybridMesh::activate() {
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

// --- maps ------------------------------------------------------------------------------------------------------------------------------------------

void HybridMesh::set_map(int node, std::shared_ptr<const PatchMap> map) {
  auto slot = std::make_shared<const MapSlot>(std::move(map));
  if (nodes_[node].map >= 0) {
    maps_[nodes_[node].map] = std::move(slot);
  } else {
    nodes_[node].map = static_cast<int>(maps_.size());
    maps_.push_back(std::move(slot));
  }
}

std::shared_ptr<const PatchMap> HybridMesh::shared_map(int node) const { return nodes_[node].map < 0 ? nullptr : maps_[nodes_[node].map]->map; }

const PatchMap* HybridMesh::map(int node) const { return shared_map(node).get(); }

const PatchSampler* HybridMesh::sampler(int node) const { return nodes_[node].map < 0 ? nullptr : &maps_[nodes_[node].map]->sampler; }

int HybridMesh::map_owner(int node) const {
  while (node >= 0 && nodes_[node].map < 0) node = nodes_[node].parent;
  return node;
}

void HybridMesh::drop_map(int node) {
  if (nodes_[node].map < 0) return;
  maps_[nodes_[node].map].reset();
  nodes_[node].map = -1;
}

void HybridMesh::drop_maps() {
  maps_.clear();
  for (Node& node : nodes_) node.map = -1;
}

bool HybridMesh::has_maps() const {
  return std::any_of(nodes_.begin(), nodes_.end(), [](const Node& node) { return node.map >= 0; });
}

}  // namespace hybrid_mesh
