// SPDX-License-Identifier: GPL-3.0-or-later
#include "construction/construction.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "base/error.h"
#include "parameterization/patch_energy.h"

namespace hybrid_mesh {
namespace {

HybridMesh hierarchy_of(const QuadGraph& base) {
  std::vector<std::array<SideLink, 4>> links(base.patch_count());
  for (int q = 0; q < base.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) links[q][i] = {base.neighbours[q][i].patch, base.neighbours[q][i].side};
  return HybridMesh::from_base(base.node_count, base.nodes, links);
}

}  // namespace

Construction::Construction(const QuadGraph& base, double area, SurfaceVersion surface, std::shared_ptr<const SizeField> sizes)
    : mesh_(hierarchy_of(base)),
      quads_(base),
      maps_(base.patch_count()),
      area_(area),
      surface_(std::move(surface)),
      sizes_(std::move(sizes)),
      nodes_(base.patch_count()) {
  std::iota(nodes_.begin(), nodes_.end(), 0);
  for (int q = 0; q < base.patch_count(); ++q) root_number_.push_back({q, q});
  begin_level();
}

Construction::Construction(HybridMesh hierarchy, const std::vector<int>& root_numbers, int level)
    : mesh_(std::move(hierarchy)), level_(level), quads_(QuadGraph()) {
  for (int i = 0; i < mesh_.operation_count(); ++i)
    if (const int finer = mesh_.operation(i).repatch.level; mesh_.operation(i).enabled && finer > level)
      throw Error(ErrorCode::InvalidInput,
                  "level " + std::to_string(level) + " cannot be laid out anew: level " + std::to_string(finer) + " has operations already");
  mesh_.refine_uniform(level);
  std::vector<int> patch_of(mesh_.node_count(), -1);
  for (int n = 0; n < mesh_.node_count(); ++n)
    if (mesh_.is_active(n) && mesh_.level(n) == level) {
      patch_of[n] = static_cast<int>(nodes_.size());
      nodes_.push_back(n);
    }
  int roots = 0;
  for (int n = 0; n < static_cast<int>(root_numbers.size()); ++n)
    if (root_numbers[n] >= 0) {
      root_number_.push_back({n, root_numbers[n]});
      roots = std::max(roots, root_numbers[n] + 1);
    }
  for (int q = 0; q < mesh_.base_count(); ++q)
    if (!mesh_.map(q)) throw Error(ErrorCode::InvalidInput, "the hierarchy has no maps to the surface any more: nothing can be laid out anew");
  QuadGraph graph;
  std::vector<QuadAddress> addresses;
  std::map<VertexId, int> number;
  for (const int n : nodes_) {
    std::array<int, 4> corners;
    std::array<PatchSide, 4> neighbours;
    for (int i = 0; i < 4; ++i) {
      corners[i] = number.insert({mesh_.corner(n, i), static_cast<int>(number.size())}).first->second;
      const SideLink link = mesh_.neighbour(n, i);
      if (link.valid()) neighbours[i] = {patch_of[link.node], link.side};
    }
    graph.nodes.push_back(corners);
    graph.neighbours.push_back(neighbours);
    const int owner = mesh_.map_owner(n);
    if (owner < 0) throw Error(ErrorCode::InvalidInput, "a quad of the hierarchy has no map to the surface: nothing can be laid out anew");
    const HybridMesh::Square square = mesh_.square_in(n, owner);
    maps_.push_back({mesh_.shared_map(owner), {square.u, square.v, square.width}});
    QuadAddress address{root_numbers[mesh_.root(n)], 1};
    std::vector<int> children;
    for (int k = n; !mesh_.is_root(k); k = mesh_.parent(k)) children.push_back(k - mesh_.first_child(mesh_.parent(k)));
    for (auto k = children.rbegin(); k != children.rend(); ++k) address = address.child(*k);
    addresses.push_back(address);
  }
  graph.node_count = static_cast<int>(number.size());
  quads_ = AddressedGraph(std::move(graph), std::move(addresses), roots);
  std::vector<Vec3> points;
  for (int q = 0; q < mesh_.base_count(); ++q) {
    area_ += map_area(*mesh_.map(q));
    points.insert(points.end(), mesh_.map(q)->positions.begin(), mesh_.map(q)->positions.end());
  }
  placement_ = placement_of(points);
  begin_level();
}

void Construction::begin_level() {
  const QuadGraph& graph = quads_.graph();
  closed_ = false;
  own_.assign(graph.patch_count(), 0);
  patches_.resize(graph.patch_count());
  std::iota(patches_.begin(), patches_.end(), 0);
  groups_ = DisjointSets(patches_.size());
  towers_.assign(graph.patch_count(), 1);
  opens_.assign(graph.patch_count(), -1);
  vertices_.assign(graph.node_count, {});
  fresh_ = 0;
  for (int q = 0; q < graph.patch_count(); ++q)
    for (int i = 0; i < 4; ++i) vertices_[graph.nodes[q][i]] = {mesh_.corner(nodes_[q], i), -1};
}

void Construction::refine() {
  close();
  mesh_.refine_uniform(++level_);
  std::vector<int> nodes;
  for (const int node : nodes_)
    for (int k = 0; k < 4; ++k) nodes.push_back(mesh_.first_child(node) + k);
  nodes_ = std::move(nodes);
  maps_ = quadrisected(state()).maps;
  quads_.quadrisect();
  begin_level();
}

void Construction::set_map(int patch, PatchMap map) {
  maps_[patch] = {std::make_shared<const PatchMap>(std::move(map)), {}};
  own_[patch] = 1;
}

void Construction::apply(MappedEdit mapped) {
  if (closed_) throw Error(ErrorCode::Internal, "an edit of a level whose operations have been made");
  change(mapped.edit, mapped.opens.empty() ? -1 : mapped.opens.front());
  for (auto& [patch, map] : mapped.maps) set_map(patch, std::move(map));
  for (const int e : mapped.opens) surface_.open[e] = true;
}

void Construction::change(const LayoutEdit& edit, int opens) {
  const std::vector<int> before = patches_;
  const int first_new = static_cast<int>(groups_.count());
  int group = -1;
  char towers = edit.rings > 0;
  for (const int q : edit.patches) {
    const int g = groups_.find(before[q]);
    if (g == group) continue;
    towers &= towers_[g];
    if (group >= 0) groups_.join(std::max(g, group), std::min(g, group));
    group = group < 0 ? g : std::min(g, group);
  }
  towers_[group] = towers;
  const LayoutChange change = quads_.apply(edit);
  const int count = quads_.graph().patch_count();
  patches_.assign(count, -1);
  std::vector<QuadMap> maps(count);
  std::vector<char> own(count, 0);
  for (std::size_t q = 0; q < change.patch.size(); ++q) {
    const int now = change.patch[q];
    if (now < 0) continue;
    patches_[now] = before[q];
    maps[now] = std::move(maps_[q]);
    own[now] = own_[q];
  }
  maps_ = std::move(maps);
  own_ = std::move(own);
  for (std::size_t k = 0; k < change.added.size(); ++k) {
    patches_[change.added[k]] = first_new + static_cast<int>(k);
    groups_.add_to(group);
    towers_.push_back(1);
    opens_.push_back(opens);
  }
  std::vector<Vertex> vertices(quads_.graph().node_count);
  for (std::size_t n = 0; n < change.node.size(); ++n)
    if (change.node[n] >= 0) vertices[change.node[n]] = n < vertices_.size() ? vertices_[n] : Vertex{VertexId(), fresh_++};
  vertices_ = std::move(vertices);
}

void Construction::close() {
  if (std::exchange(closed_, true)) return;
  const std::vector<int> old = nodes_;
  const int old_count = static_cast<int>(old.size());
  // Quads by group: those of the level that are gone, and those that came.
  std::map<int, Group> groups;
  std::vector<char> left(old_count, 0);
  std::vector<int> nodes(patches_.size(), -1);
  for (std::size_t q = 0; q < patches_.size(); ++q) {
    if (patches_[q] < old_count) {
      left[patches_[q]] = 1;
      nodes[q] = old[patches_[q]];
    } else {
      groups[groups_.find(patches_[q])].added.push_back(static_cast<int>(q));
    }
  }
  for (int q = 0; q < old_count; ++q)
    if (!left[q]) groups[groups_.find(q)].removed.push_back(old[q]);
  for (const auto& [name, group] : groups) insert(group, towers_[name], nodes);
  for (std::size_t q = 0; q < nodes.size(); ++q) {
    if (patches_[q] >= old_count) root_number_.push_back({nodes[q], quads_.address(static_cast<int>(q)).root});
    if (const int event = opens_[patches_[q]]; event >= 0) opened_.push_back({nodes[q], event});
  }
  nodes_ = std::move(nodes);
  for (std::size_t q = 0; q < nodes_.size(); ++q)
    if (own_[q]) mesh_.set_map(nodes_[q], maps_[q].map);
}

void Construction::insert(const Group& group, bool towers, std::vector<int>& nodes) {
  const QuadGraph& graph = quads_.graph();
  Repatch repatch;
  repatch.kind = towers ? "add_cubes" : "repatch";
  repatch.level = level();
  repatch.removed = group.removed;
  std::vector<char> inside(graph.patch_count(), 0);
  for (const int q : group.added) inside[q] = 1;
  // A vertex of the level stays where a side that is not between two new quads holds it; else the operation has taken it, and made another in its
  // place.
  std::map<int, int> corner_of;  // by node of the graph
  for (const int q : group.added)
    for (int i = 0; i < 4; ++i) {
      const PatchSide other = graph.neighbours[q][i];
      if (other.patch >= 0 && inside[other.patch]) continue;
      for (const int n : {graph.nodes[q][i], graph.nodes[q][(i + 1) % 4]})
        if (vertices_[n].old.valid() && corner_of.insert({n, static_cast<int>(repatch.boundary.size())}).second)
          repatch.boundary.push_back(vertices_[n].old);
    }
  for (const int q : group.added) {
    std::array<int, 4> quad;
    for (int i = 0; i < 4; ++i) {
      const auto [it, fresh] = corner_of.insert({graph.nodes[q][i], -1 - repatch.new_vertices});
      if (fresh) ++repatch.new_vertices;
      quad[i] = it->second;
    }
    repatch.quads.push_back(quad);
  }
  const std::string refusal = mesh_.apply(repatch);
  if (!refusal.empty()) throw Error(ErrorCode::InvalidInput, "an operation of level " + std::to_string(level()) + " is refused: " + refusal);
  const std::vector<int>& roots = mesh_.operation(mesh_.operation_count() - 1).roots;
  for (std::size_t k = 0; k < group.added.size(); ++k) nodes[group.added[k]] = roots[k];
}

std::vector<int> Construction::root_numbers() const {
  std::vector<int> number(mesh_.node_count(), -1);
  for (const auto& [node, root] : root_number_) number[node] = root;
  return number;
}

std::vector<int> Construction::opened() const {
  std::vector<int> event(mesh_.node_count(), -1);
  for (const auto& [node, opens] : opened_) event[node] = opens;
  return event;
}

}  // namespace hybrid_mesh
