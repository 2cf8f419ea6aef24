// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/archive.h"

#include <algorithm>

#include "base/error.h"

namespace hybrid_mesh {

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::InvalidInput, message); }

}  // namespace

// A friend of HybridMesh.
class HierarchyArchive {
 public:
  // Builds the forest in canonical order: `refined(node)` tells whether a node has children, `operation(i)` is the i-th operation in the new
  // numbering, of level `level(i)`, ascending; `made(first, count)` is called for new nodes.
  template <class Refined, class Made, class Level, class GetOperation>
  static void grow(HybridMesh& mesh, int operations, const Refined& refined, const Level& level, const GetOperation& operation, const Made& made) {
    made(0, mesh.node_count());
    int n = 0, o = 0;
    for (int j = 0; n < mesh.node_count(); ++j) {
      // All nodes of level j stand at [n, end).
      for (const int end = mesh.node_count(); n < end; ++n)
        if (refined(n)) {
          const int first = mesh.refine(n);
          made(first, 4);
        }
      for (; o < operations && level(o) == j + 1; ++o) {
        HybridMesh::Operation op;
        op.repatch = operation(o);
        if (op.repatch.sides.size() != op.repatch.quads.size()) refuse("an operation without its sides");
        const std::string reason = mesh.validate(op.repatch);
        if (!reason.empty()) refuse(reason);
        const int first = mesh.node_count();
        mesh.append(std::move(op));
        made(first, mesh.node_count() - first);
      }
    }
    if (o < operations) refuse("an operation of a level that does not exist");
    if (operations > 0) mesh.count_leaves();  // refinement alone keeps count
  }

  static std::vector<std::array<int, 4>> base_quads(const HybridMesh& mesh) {
    std::vector<std::array<int, 4>> quads(mesh.base_count_);
    for (int q = 0; q < mesh.base_count_; ++q)
      for (int s = 0; s < 4; ++s) quads[q][s] = mesh.corner(q, s).index();
    return quads;
  }

  static std::vector<std::array<SideLink, 4>> base_links(const HybridMesh& mesh) {
    std::vector<std::array<SideLink, 4>> links(mesh.base_count_);
    for (int q = 0; q < mesh.base_count_; ++q)
      for (int s = 0; s < 4; ++s) links[q][s] = mesh.neighbour(q, s);
    return links;
  }

  static std::vector<std::uint8_t> sharp_sides(const HybridMesh& mesh) {
    std::vector<std::uint8_t> sharp;
    if (!mesh.has_sharp_sides()) return sharp;
    sharp.resize(mesh.base_count_, 0);
    for (int q = 0; q < mesh.base_count_; ++q)
      for (int s = 0; s < 4; ++s) sharp[q] |= static_cast<std::uint8_t>(mesh.is_sharp(q, s) << s);
    return sharp;
  }

  static HybridMesh canonical(const HybridMesh& old) {
    HybridMesh mesh;
    if (old.node_count() == 0) return mesh;
    mesh = HybridMesh::from_base(old.base_vertices_, base_quads(old), base_links(old));
    mesh.take_sharp_sides(old);
    std::vector<int> order(old.operations_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return old.operations_[a].repatch.level < old.operations_[b].repatch.level; });

    std::vector<int> old_node, new_node(old.nodes_.size(), -1), new_free(old.free_.size(), -1);
    std::vector<HalfEdge> new_half(2 * old.edges_.size(), -1);
    for (int v = 0; v < old.base_vertices_; ++v) new_free[v] = v;
    const auto vertex = [&](VertexId v) {
      switch (v.kind()) {
        case VertexId::Kind::Free:
          return VertexId(v.kind(), new_free[v.index()]);
        case VertexId::Kind::Edge:
          return VertexId(v.kind(), new_half[2 * v.index()] >> 1);
        default:
          return VertexId(v.kind(), new_node[v.index()]);
      }
    };
    int current = 0;  // operation whose root quads are being made
    const auto made = [&](int first, int count) {
      const int parent = mesh.nodes_[first < mesh.node_count() ? first : 0].parent;
      for (int i = 0; i < count; ++i) {
        const int n = first + i;
        const int o = parent >= 0 ? old.nodes_[old_node[parent]].child + i : n < mesh.base_count_ ? n : old.operations_[order[current]].roots[i];
        old_node.push_back(o);
        new_node[o] = n;
        for (int s = 0; s < 4; ++s) {
          new_half[old.nodes_[o].half[s]] = mesh.nodes_[n].half[s];
          new_half[old.nodes_[o].half[s] ^ 1] = mesh.nodes_[n].half[s] ^ 1;
        }
      }
    };
    grow(
        mesh, old.operation_count(), [&](int n) { return old.nodes_[old_node[n]].child >= 0; },
        [&](int o) { return old.operations_[order[o]].repatch.level; },
        [&](int o) {
          current = o;
          Repatch repatch = old.operations_[order[o]].repatch;
          for (int& n : repatch.removed) n = new_node[n];
          for (VertexId& v : repatch.boundary) v = vertex(v);
          for (auto& sides : repatch.sides)
            for (auto& side : sides)
              if (side.kind == Repatch::Side::Kind::Outer) side.half = new_half[side.half];
          for (int v = 0; v < repatch.new_vertices; ++v)
            new_free[old.operations_[order[o]].first_vertex + v] = static_cast<int>(mesh.free_.size()) + v;
          return repatch;
        },
        made);
    for (std::size_t o = 0; o < order.size(); ++o) mesh.operations_[o].enabled = old.operations_[order[o]].enabled;
    mesh.activate();

    const auto translate = [&](HybridMesh::Positions positions) {
      for (auto& [v, point] : positions) v = vertex(v);
      std::sort(positions.begin(), positions.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
      return positions;
    };
    for (const auto& positions : old.level_positions_) mesh.level_positions_.push_back(translate(positions));
    mesh.final_positions_ = translate(old.final_positions_);
    mesh.closure_ = old.closure_;
    for (int n = 0; n < mesh.node_count(); ++n) {
      const int map = old.nodes_[old_node[n]].map;
      if (map < 0) continue;
      mesh.nodes_[n].map = static_cast<int>(mesh.maps_.size());
      mesh.maps_.push_back(old.maps_[map]);
    }
    return mesh;
  }

  static HierarchyParts take_apart(const HybridMesh& given) {
    const HybridMesh mesh = canonical(given);
    HierarchyParts parts;
    parts.base_vertices = mesh.base_vertices_;
    parts.base_quads = base_quads(mesh);
    parts.base_links = base_links(mesh);
    parts.sharp = sharp_sides(mesh);
    for (const auto& node : mesh.nodes_) parts.refined.push_back(node.child >= 0);
    for (const auto& op : mesh.operations_) {
      parts.operations.push_back(op.repatch);
      parts.enabled.push_back(op.enabled);
    }
    parts.closure = mesh.closure_;
    parts.level_positions = mesh.level_positions_;
    while (!parts.level_positions.empty() && parts.level_positions.back().empty()) parts.level_positions.pop_back();
    parts.final_positions = mesh.final_positions_;
    for (int n = 0; n < mesh.node_count(); ++n)
      if (const PatchMap* map = mesh.map(n)) parts.maps.emplace_back(n, *map);
    return parts;
  }

  static void check_positions(const HybridMesh& mesh, const HybridMesh::Positions& positions) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const VertexId v = positions[i].first;
      const std::size_t limit = v.kind() == VertexId::Kind::Free   ? mesh.free_.size()
                                : v.kind() == VertexId::Kind::Edge ? mesh.edges_.size()
                                : v.kind() == VertexId::Kind::Node ? mesh.nodes_.size()
                                                                   : 0;
      if (!v.valid() || static_cast<std::size_t>(v.index()) >= limit) refuse("a position of a vertex that does not exist");
      if (i > 0 && !(positions[i - 1].first < v)) refuse("positions out of order");
      if (!positions[i].second.allFinite()) refuse("a position that is not finite");
    }
  }

  static void check_map(const PatchMap& map) {
    if (map.triangles.empty() || map.positions.size() != map.uv.size() || map.source.size() != map.source_face.size() ||
        (!map.source.empty() && map.source.size() != map.triangles.size()))
      refuse("a map of lists that do not fit together");
    const int vertices = static_cast<int>(map.uv.size());
    for (const auto& t : map.triangles)
      for (int c : t)
        if (c < 0 || c >= vertices) refuse("a map with a corner out of range");
    for (int v = 0; v < vertices; ++v)
      if (!map.uv[v].allFinite() || !map.positions[v].allFinite() || map.uv[v].minCoeff() < 0 || map.uv[v].maxCoeff() > 1)
        refuse("a map with a value out of range");
  }

  static HybridMesh put_together(HierarchyParts parts) {
    if (parts.base_quads.empty()) {
      if (parts.base_vertices || !parts.refined.empty() || !parts.operations.empty() || !parts.maps.empty() || !parts.final_positions.empty() ||
          !parts.level_positions.empty())
        refuse("a hierarchy without a base domain");
      HybridMesh empty;
      empty.set_closure(parts.closure);
      return empty;
    }
    if (parts.base_vertices < 0 || static_cast<std::size_t>(parts.base_vertices) > 4 * parts.base_quads.size())
      refuse("a number of base vertices out of range");
    HybridMesh mesh = HybridMesh::from_base(parts.base_vertices, parts.base_quads, parts.base_links);
    if (!parts.sharp.empty() && parts.sharp.size() != parts.base_quads.size()) refuse("sharp sides and base quads differ in number");
    for (std::size_t q = 0; q < parts.sharp.size(); ++q)
      for (int s = 0; s < 4; ++s)
        if ((parts.sharp[q] >> s) & 1) mesh.set_sharp(static_cast<int>(q), s);
    if (parts.enabled.size() != parts.operations.size()) refuse("operations and choices differ in number");
    for (std::size_t o = 1; o < parts.operations.size(); ++o)
      if (parts.operations[o].level < parts.operations[o - 1].level) refuse("operations out of order");
    grow(
        mesh, static_cast<int>(parts.operations.size()),
        [&](int n) {
          if (static_cast<std::size_t>(n) >= parts.refined.size()) refuse("more quads than were announced");
          return parts.refined[n] != 0 &&
                 (static_cast<std::size_t>(mesh.node_count()) + 4 <= parts.refined.size() ? true : (refuse("more quads than were announced"), false));
        },
        [&](int o) { return parts.operations[o].level; }, [&](int o) { return parts.operations[o]; }, [](int, int) {});
    if (static_cast<std::size_t>(mesh.node_count()) != parts.refined.size()) refuse("fewer quads than were announced");
    std::string reason = mesh.find_choice_defect();
    if (!reason.empty()) refuse(reason);
    reason = mesh.set_enabled(parts.enabled);
    if (!reason.empty()) refuse(reason);
    if (parts.level_positions.size() > HybridMesh::max_level + 1) refuse("positions of too many levels");
    for (const auto& positions : parts.level_positions) check_positions(mesh, positions);
    check_positions(mesh, parts.final_positions);
    mesh.level_positions_ = std::move(parts.level_positions);
    mesh.final_positions_ = std::move(parts.final_positions);
    mesh.closure_ = parts.closure;
    int last = -1;
    for (auto& [node, map] : parts.maps) {
      if (node <= last || node >= mesh.node_count()) refuse("a map of a quad out of range");
      last = node;
      check_map(map);
      mesh.set_map(node, std::move(map));
    }
    return mesh;
  }
};

HybridMesh HybridMesh::canonical() const { return HierarchyArchive::canonical(*this); }

HierarchyParts take_apart(const HybridMesh& mesh) { return HierarchyArchive::take_apart(mesh); }

HybridMesh put_together(HierarchyParts parts) { return HierarchyArchive::put_together(std::move(parts)); }

}  // namespace hybrid_mesh
