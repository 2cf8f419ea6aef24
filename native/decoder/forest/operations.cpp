// SPDX-License-Identifier: GPL-3.0-or-later
// Irregular operations: quads of one level replaced by others.
#include <algorithm>
#include <map>
#include <set>

#include "decoder/error.h"
#include "decoder/forest/quad_forest.h"

namespace hybrid_mesh {

namespace {

using Side = Repatch::Side;

std::string side_name(std::size_t quad, int side) { return "side " + std::to_string(side) + " of new quad " + std::to_string(quad); }

}  // namespace

// Fills in `sides` from pairs of corners where they are not given.
std::string QuadForest::complete_sides(Repatch& repatch) const {
  if (!repatch.sides.empty() || repatch.quads.empty()) return "";
  for (const auto& quad : repatch.quads)
    for (int c : quad)
      if (c >= static_cast<int>(repatch.boundary.size()) || -1 - c >= repatch.new_vertices) return "a new quad with a corner out of range";
  std::map<std::pair<int, int>, Side> inside;
  for (std::size_t q = 0; q < repatch.quads.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      Side side;
      side.kind = Side::Kind::Patch;
      side.quad = static_cast<int>(q);
      side.side = s;
      if (!inside.try_emplace({repatch.quads[q][s], repatch.quads[q][(s + 1) % 4]}, side).second)
        return "two sides of new quads run between the same corners in the same direction: sides must be given";
    }
  std::set<int> removed(repatch.removed.begin(), repatch.removed.end());
  std::map<std::pair<VertexId, VertexId>, std::vector<HalfEdge>> outside;
  for (int n : removed) {
    if (n < 0 || n >= node_count()) return "a quad to be removed that does not exist";
    for (HalfEdge h : nodes_[n].half)
      if (holder_[h ^ 1] < 0 || !removed.count(holder_[h ^ 1] / 4)) outside[{from(h), to(h)}].push_back(h);
  }
  for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
    if (edges_[e].level != repatch.level) continue;
    for (HalfEdge h : {2 * e, 2 * e + 1})
      if (holder_[h ^ 1] >= 0 && !removed.count(holder_[h ^ 1] / 4) && !holder_or_coarser(h).valid() && !finer(h))
        outside[{from(h), to(h)}].push_back(h);
  }
  repatch.sides.resize(repatch.quads.size());
  for (std::size_t q = 0; q < repatch.quads.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      const int a = repatch.quads[q][s], b = repatch.quads[q][(s + 1) % 4];
      Side& side = repatch.sides[q][s];
      const auto across = inside.find({b, a});
      const auto hole = a >= 0 && b >= 0 ? outside.find({repatch.boundary[a], repatch.boundary[b]}) : outside.end();
      if (across != inside.end() && hole != outside.end()) return side_name(q, s) + " can be glued in two ways: sides must be given";
      if (across != inside.end()) {
        side = across->second;
      } else if (hole != outside.end()) {
        if (hole->second.size() > 1) return side_name(q, s) + " can be glued in two ways: sides must be given";
        side.kind = Side::Kind::Outer;
        side.half = hole->second[0];
      }
    }
  return "";
}

std::string QuadForest::validate(const Repatch& repatch) const {
  const int level = repatch.level;
  if (level < 1 || level >= max_level) return "an operation of level " + std::to_string(level) + "; levels from 1 on can be changed";
  for (const Operation& op : operations_)
    if (!op.enabled) return "an operation can be applied only with all earlier ones enabled";
  if (repatch.removed.empty() && repatch.quads.empty()) return "an operation that does nothing";
  if (nodes_.size() + repatch.quads.size() > (1u << 28) || repatch.new_vertices < 0 ||
      repatch.new_vertices > 4 * static_cast<int>(repatch.quads.size()))
    return "a number of new vertices out of range";

  std::vector<int> removed = repatch.removed;
  std::sort(removed.begin(), removed.end());
  if (std::adjacent_find(removed.begin(), removed.end()) != removed.end()) return "a quad that is removed twice";
  const auto is_removed = [&](int n) { return std::binary_search(removed.begin(), removed.end(), n); };
  for (int n : removed) {
    if (n < 0 || n >= node_count()) return "a quad to be removed that does not exist";
    if (is_root(n)) return "a root quad cannot be removed";
    if (nodes_[n].level != level)
      return "a quad to be removed that is of level " + std::to_string(nodes_[n].level) + ", not " + std::to_string(level);
    if (removed_by(n) >= 0) return "a quad to be removed that another operation removes";
    if (!nodes_[n].active) return "a quad to be removed that is below a removed one";
  }

  std::vector<char> vertex_used(repatch.new_vertices, 0);
  for (VertexId v : repatch.boundary) {
    const int i = v.index();
    const bool exists = v.valid() && (v.kind() == VertexId::Kind::Free   ? i < static_cast<int>(free_.size())
                                      : v.kind() == VertexId::Kind::Edge ? i < static_cast<int>(edges_.size())
                                      : v.kind() == VertexId::Kind::Node ? i < node_count()
                                                                         : false);
    if (!exists) return "a boundary vertex that does not exist";
    if (birth_level(v) > level) return "a boundary vertex of a finer level";
  }
  for (const auto& quad : repatch.quads)
    for (int c : quad)
      if (c >= static_cast<int>(repatch.boundary.size()) || -1 - c >= repatch.new_vertices) return "a new quad with a corner out of range";
  for (const auto& quad : repatch.quads)
    for (int c : quad) {
      if (c < 0) vertex_used[-1 - c] = 1;
      const auto name = [&](int k) { return k < 0 ? k : static_cast<int>(repatch.boundary[k].code); };
      if (std::count_if(quad.begin(), quad.end(), [&](int k) { return name(k) == name(c); }) > 1) return "a new quad with the same corner twice";
    }
  if (std::find(vertex_used.begin(), vertex_used.end(), 0) != vertex_used.end()) return "a new vertex without a quad";

  // Sides: mutual inside, on free or freed half-edges outside.
  if (repatch.sides.size() != repatch.quads.size()) return "sides and new quads differ in number";
  std::set<HalfEdge> taken;
  std::set<VertexId> anchored;  // existing vertices that the patch is glued to by a side
  for (std::size_t q = 0; q < repatch.quads.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      const Side& side = repatch.sides[q][s];
      const int a = repatch.quads[q][s], b = repatch.quads[q][(s + 1) % 4];
      if (side.kind == Side::Kind::Patch) {
        if (side.quad < 0 || side.quad >= static_cast<int>(repatch.quads.size()) || side.side < 0 || side.side > 3)
          return side_name(q, s) + " has a neighbour out of range";
        const Side& back = repatch.sides[side.quad][side.side];
        if (back.kind != Side::Kind::Patch || back.quad != static_cast<int>(q) || back.side != s ||
            (side.quad == static_cast<int>(q) && side.side == s))
          return side_name(q, s) + " has a neighbour that is not mutual";
        if (repatch.quads[side.quad][side.side] != b || repatch.quads[side.quad][(side.side + 1) % 4] != a)
          return side_name(q, s) + " and its neighbour do not share corners in opposite directions";
      } else if (side.kind == Side::Kind::Outer) {
        const HalfEdge h = side.half;
        if (h < 0 || h >= static_cast<int>(holder_.size())) return side_name(q, s) + " takes a half-edge that does not exist";
        if (edges_[h >> 1].level != level) return side_name(q, s) + " takes an edge of another level";
        if (a < 0 || b < 0 || repatch.boundary[a] != from(h) || repatch.boundary[b] != to(h))
          return side_name(q, s) + " takes an edge between other vertices";
        if (!taken.insert(h).second) return side_name(q, s) + " takes an edge twice";
        const bool freed = holder_[h] >= 0 && is_removed(holder_[h] / 4);
        if (!freed) {
          if (holder_or_coarser(h).valid() || finer(h)) return side_name(q, s) + " takes the place of a quad that stays";
          if (!holder_or_coarser(h ^ 1).valid()) return side_name(q, s) + " takes an edge that no quad has";
        }
        anchored.insert(from(h));
        anchored.insert(to(h));
      } else if (side.kind != Side::Kind::Open) {
        return side_name(q, s) + " is of no known kind";
      }
    }
  for (const auto& quad : repatch.quads)
    for (int c : quad)
      if (c >= 0 && !anchored.count(repatch.boundary[c])) return "a new quad that touches an existing vertex without an edge there";

  // Finer operations must keep the ground they stand on.
  const auto in_region = [&](int n) {
    while (n >= 0 && nodes_[n].level > level) n = nodes_[n].parent;
    return n >= 0 && nodes_[n].level == level && is_removed(n);
  };
  for (const Operation& op : operations_) {
    if (op.repatch.level <= level) continue;
    for (int n : op.repatch.removed)
      if (in_region(n)) return "an operation of level " + std::to_string(op.repatch.level) + " changes quads below the ones to be removed";
    for (int root : op.roots)
      for (int s = 0; s < 4; ++s) {
        const SideLink other = neighbour(root, s);
        if (!other.valid() || !in_region(other.node)) continue;
        HalfEdge h = nodes_[root].half[s] ^ 1;
        while (h >= 0 && edges_[h >> 1].level > level) h = half_parent(h);
        if (h < 0 || !taken.count(h)) return "an operation of level " + std::to_string(op.repatch.level) + " is joined to the quads to be removed";
      }
  }
  return "";
}

// Operations without which the half-edges or quads that this one uses would not be there.
std::vector<int> QuadForest::dependencies(const Repatch& repatch) const {
  std::set<int> result;
  const auto add_root = [&](int n) {
    if (inserted_by(n) >= 0) result.insert(inserted_by(n));
  };
  for (int n : repatch.removed) add_root(n);
  for (const auto& quad : repatch.sides)
    for (const Side& side : quad) {
      if (side.kind != Side::Kind::Outer) continue;
      HalfEdge h = side.half;
      // An edge made by an operation, or inside a quad made by one.
      int top = h >> 1;
      while (edges_[top].parent >= 0) top = edges_[top].parent;
      add_root(edges_[top].origin / 4);
      if (holder_[h] >= 0) continue;
      for (; h >= 0; h = half_parent(h)) {
        const auto freed = freed_by_.find(h);
        if (freed != freed_by_.end()) result.insert(freed->second);
      }
    }
  return {result.begin(), result.end()};
}

void QuadForest::deactivate(int top) {
  std::vector<int> stack{top};
  while (!stack.empty()) {
    const int n = stack.back();
    stack.pop_back();
    Node& node = nodes_[n];
    if (!node.active) continue;
    node.active = false;
    for (int s = 0; s < 4; ++s)
      if (holder_[node.half[s]] == 4 * n + s) holder_[node.half[s]] = -1;
    if (node.child >= 0)
      for (int k = 0; k < 4; ++k) stack.push_back(node.child + k);
  }
}

// Adds a valid operation; the counts of the leaves are left to the caller.
void QuadForest::append(Operation op) {
  const Repatch& repatch = op.repatch;
  op.depends = dependencies(repatch);
  op.roots.clear();
  op.enabled = true;
  const int index = operation_count(), level = repatch.level;
  op.first_vertex = static_cast<int>(free_.size());
  free_.resize(free_.size() + repatch.new_vertices);
  const auto corner_id = [&](int c) { return c >= 0 ? repatch.boundary[c] : VertexId(VertexId::Kind::Free, op.first_vertex - 1 - c); };
  for (int n : repatch.removed) {
    deactivate(n);
    nodes_[n].operation = index;
    for (HalfEdge h : nodes_[n].half) freed_by_[h] = index;
  }
  for (std::size_t q = 0; q < repatch.quads.size(); ++q) {
    Node node;
    node.root = static_cast<int>(nodes_.size());
    node.operation = index;
    node.level = static_cast<std::int8_t>(level);
    op.roots.push_back(node.root);
    nodes_.push_back(node);
    for (int s = 0; s < 4; ++s) {
      const int c = repatch.quads[q][s];
      if (c >= 0) continue;
      FreeVertex& v = free_[op.first_vertex - 1 - c];
      if (v.origin < 0) v.origin = 4 * node.root + s;
      v.level = static_cast<std::int8_t>(level);
    }
  }
  for (std::size_t q = 0; q < repatch.quads.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      const Side& side = repatch.sides[q][s];
      const int root = op.roots[q];
      if (side.kind == Side::Kind::Outer) {
        nodes_[root].half[s] = side.half;
      } else if (nodes_[root].half[s] < 0) {
        const int e = add_edge(corner_id(repatch.quads[q][s]), corner_id(repatch.quads[q][(s + 1) % 4]), level, 4 * root + s);
        nodes_[root].half[s] = 2 * e;
        if (side.kind == Side::Kind::Patch) nodes_[op.roots[side.quad]].half[side.side] = 2 * e + 1;
      }
    }
  for (int root : op.roots)
    for (int s = 0; s < 4; ++s) holder_[nodes_[root].half[s]] = 4 * root + s;
  operations_.push_back(std::move(op));
}

// Two edges between the same vertices would make a level that is no mesh by its vertices alone. Of two such edges that operations made, the one of
// the finer level finds the other; so an operation is looked at again after coarser ones.
std::string QuadForest::find_double_edge(int least_level) const {
  for (const Operation& op : operations_) {
    if (!op.enabled || op.repatch.level < least_level) continue;
    const std::string reason = find_double_edge(op);
    if (!reason.empty()) return reason;
  }
  return "";
}

std::string QuadForest::find_double_edge(const Operation& op) const {
  const int cap = op.repatch.level;
  for (std::size_t q = 0; q < op.roots.size(); ++q)
    for (int s = 0; s < 4; ++s) {
      if (op.repatch.sides[q][s].kind == Side::Kind::Outer) continue;
      const HalfEdge start = nodes_[op.roots[q]].half[s];
      int same = 0;
      HalfEdge h = start;
      bool closed = false;
      do {  // `start` has a quad to its left
        same += to(h) == to(start);
        const Sector sector = sector_left(h, cap);
        if (sector.node < 0) break;
        h = sector.next;
        closed = h == start;
      } while (!closed);
      for (h = start; !closed;) {
        const Sector sector = sector_right(h, cap);
        if (sector.node < 0) break;
        h = sector.next;
        same += to(h) == to(start);
      }
      if (same > 1) return side_name(q, s) + " would be a second edge between the same vertices";
    }
  return "";
}

std::string QuadForest::apply(const Repatch& repatch) {
  Operation op;
  op.repatch = repatch;
  std::string reason = complete_sides(op.repatch);
  if (reason.empty()) reason = validate(op.repatch);
  if (!reason.empty()) return reason;
  const std::size_t old_nodes = nodes_.size(), old_edges = edges_.size(), old_free = free_.size();
  append(std::move(op));
  for (int cap = repatch.level, last = deepest_level(); cap <= last && reason.empty(); ++cap) reason = find_fan_defect(cap);
  if (reason.empty()) reason = find_double_edge(repatch.level);
  if (reason.empty() && leaves().empty()) reason = "nothing would be left of the mesh";
  if (reason.empty()) {
    count_leaves();
    return "";
  }
  for (int n : operations_.back().repatch.removed) {
    nodes_[n].operation = -1;
    for (HalfEdge h : nodes_[n].half) freed_by_.erase(h);
  }
  operations_.pop_back();
  nodes_.resize(old_nodes);
  edges_.resize(old_edges);
  holder_.resize(2 * old_edges);
  free_.resize(old_free);
  activate();
  return reason;
}

std::vector<bool> QuadForest::enabled() const {
  std::vector<bool> result;
  for (const Operation& op : operations_) result.push_back(op.enabled);
  return result;
}

// Why the enabled operations together make no hierarchy.
std::string QuadForest::find_choice_defect() const {
  // Regular refinement of a manifold is one.
  if (operations_.empty()) return "";
  if (leaves().empty()) return "nothing would be left of the mesh";
  // The other levels are regular refinements of these, or of the base.
  std::set<int> levels;
  for (const Operation& op : operations_)
    if (op.enabled) levels.insert(op.repatch.level);
  for (const int cap : levels) {
    const std::string reason = find_fan_defect(cap);
    if (!reason.empty()) return reason;
  }
  // An edge made by one operation may double one that another has removed.
  return find_double_edge(0);
}

std::string QuadForest::set_enabled(const std::vector<bool>& enabled) {
  if (enabled.size() != operations_.size()) return "as many choices are needed as there are operations";
  for (std::size_t o = 0; o < operations_.size(); ++o)
    for (int d : operations_[o].depends)
      if (enabled[o] && !enabled[d]) return "operation " + std::to_string(o) + " needs operation " + std::to_string(d);
  const std::vector<bool> before = this->enabled();
  if (enabled == before) return "";
  for (std::size_t o = 0; o < operations_.size(); ++o) operations_[o].enabled = enabled[o];
  activate();
  const std::string reason = find_choice_defect();
  if (reason.empty()) return "";
  for (std::size_t o = 0; o < operations_.size(); ++o) operations_[o].enabled = before[o];
  activate();
  return reason;
}

}  // namespace hybrid_mesh
