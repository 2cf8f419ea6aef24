// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/mirrored.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/found.h"

namespace hybrid_mesh {
namespace {

// Of corners; of children as well.
constexpr std::array<int, 4> kExchanged{0, 3, 2, 1};

class Mirroring {
 public:
  explicit Mirroring(const HybridMesh& half) : half_(half) {}

  Mirrored run() {
    make_base();
    // Nodes have the numbers in whose order they were made.
    for (int n = half_.base_count(); n < half_.node_count(); ++n) {
      if (out_.node[n] >= 0) continue;
      if (half_.is_root(n))
        apply(half_.operation(half_.inserted_by(n)));
      else
        refine(half_.parent(n));
    }
    out_.mesh.set_closure(half_.closure());
    name_vertices();
    return std::move(out_);
  }

 private:
  void make_base() {
    const int quads = half_.base_count(), vertices = half_.base_vertex_count();
    std::vector<int> image(vertices, -1);
    for (int q = 0; q < quads; ++q)
      for (int s = 0; s < 4; ++s)
        if (half_.is_on_mirror(q, s))
          for (const int c : {s, (s + 1) % 4}) image[half_.corner(q, c).index()] = half_.corner(q, c).index();
    int count = vertices;
    for (int& v : image)
      if (v < 0) v = count++;
    std::vector<std::array<int, 4>> corners(2 * quads);
    std::vector<std::array<SideLink, 4>> links(2 * quads);
    for (int q = 0; q < quads; ++q)
      for (int s = 0; s < 4; ++s) {
        corners[q][s] = half_.corner(q, s).index();
        corners[quads + q][kExchanged[s]] = image[corners[q][s]];
        const SideLink link = half_.root_neighbour(q, s);
        if (half_.is_on_mirror(q, s)) {
          links[q][s] = {quads + q, 3 - s};
          links[quads + q][3 - s] = {q, s};
        } else if (link.valid()) {
          links[q][s] = link;
          links[quads + q][3 - s] = {quads + link.node, 3 - link.side};
        }
      }
    out_.mesh = HybridMesh::from_base(count, corners, links);
    out_.node.assign(half_.node_count(), -1);
    out_.image.assign(half_.node_count(), -1);
    for (int q = 0; q < quads; ++q) {
      take_root(q, q, quads + q);
      for (int s = 0; s < 4; ++s)
        if (half_.is_sharp(q, s)) {
          out_.mesh.set_sharp(q, s);
          out_.mesh.set_sharp(quads + q, 3 - s);
        }
    }
  }

  // The nodes that a node of the half is, and its sides.
  void take(int n, int node, int image) {
    out_.node[n] = node;
    out_.image[n] = image;
    for (int s = 0; s < 4; ++s) {
      const HalfEdge h = half_.half_edge(n, s);
      half_edge_[h] = out_.mesh.half_edge(node, s);
      half_edge_[h ^ 1] = half_edge_[h] ^ 1;
      image_edge_[h] = out_.mesh.half_edge(image, 3 - s);
      image_edge_[h ^ 1] = image_edge_[h] ^ 1;
    }
  }

  void take_root(int n, int node, int image) {
    take(n, node, image);
    for (int c = 0; c < 4; ++c)
      if (const VertexId v = half_.corner(n, c); v.kind() == VertexId::Kind::Free)
        free_[v] = {out_.mesh.corner(node, c), out_.mesh.corner(image, kExchanged[c])};
  }

  void refine(int n) {
    const int node = out_.mesh.refine(out_.node[n]), image = out_.mesh.refine(out_.image[n]);
    for (int k = 0; k < 4; ++k) take(half_.first_child(n) + k, node + k, image + kExchanged[k]);
  }

  VertexId vertex(VertexId v, bool is_image) const {
    if (v.kind() == VertexId::Kind::Node) return {v.kind(), is_image ? out_.image[v.index()] : out_.node[v.index()]};
    if (v.kind() == VertexId::Kind::Edge) return {v.kind(), (is_image ? image_edge_ : half_edge_).at(2 * v.index()) >> 1};
    const auto& [own, other] = free_.at(v);
    return is_image ? other : own;
  }

  void apply(const HybridMesh::Operation& operation) {
    const Repatch& old = operation.repatch;
    const int quads = static_cast<int>(old.quads.size()), corners = static_cast<int>(old.boundary.size());
    // New vertices on a marked side are their own images.
    std::vector<int> image(old.new_vertices, -1);
    for (int q = 0; q < quads; ++q)
      for (int s = 0; s < 4; ++s)
        if (old.sides[q][s].kind == Repatch::Side::Kind::Open && half_.is_on_mirror(operation.roots[q], s))
          for (const int c : {old.quads[q][s], old.quads[q][(s + 1) % 4]})
            if (c < 0) image[-1 - c] = -1 - c;
    Repatch both = old;
    for (int& v : image)
      if (v < 0) v = both.new_vertices++;
    for (int& n : both.removed) n = out_.node[n];
    for (const int n : old.removed) both.removed.push_back(out_.image[n]);
    for (VertexId& v : both.boundary) v = vertex(v, false);
    std::vector<int> place(corners);
    for (int k = 0; k < corners; ++k) {
      const VertexId v = vertex(old.boundary[k], true);
      const auto at = std::find(both.boundary.begin(), both.boundary.end(), v);
      place[k] = static_cast<int>(at - both.boundary.begin());
      if (at == both.boundary.end()) both.boundary.push_back(v);
    }
    both.quads.resize(2 * quads);
    both.sides.resize(2 * quads);
    for (int q = 0; q < quads; ++q)
      for (int s = 0; s < 4; ++s) {
        const int c = old.quads[q][s];
        both.quads[quads + q][kExchanged[s]] = c < 0 ? -1 - image[-1 - c] : place[c];
        const Repatch::Side& side = old.sides[q][s];
        Repatch::Side &own = both.sides[q][s], &other = both.sides[quads + q][3 - s];
        other = side;
        if (side.kind == Repatch::Side::Kind::Patch) {
          other.quad = quads + side.quad;
          other.side = 3 - side.side;
        } else if (side.kind == Repatch::Side::Kind::Outer) {
          own.half = half_edge_.at(side.half);
          other.half = image_edge_.at(side.half);
        } else if (half_.is_on_mirror(operation.roots[q], s)) {
          own = {Repatch::Side::Kind::Patch, quads + q, 3 - s, -1};
          other = {Repatch::Side::Kind::Patch, q, s, -1};
        }
      }
    const std::string refusal = out_.mesh.apply(both);
    if (!refusal.empty()) throw NoMap("an irregular operation and its mirror image do not go together: " + refusal);
    const std::vector<int>& roots = out_.mesh.operation(out_.mesh.operation_count() - 1).roots;
    for (int q = 0; q < quads; ++q) take_root(operation.roots[q], roots[q], roots[quads + q]);
  }

  void name_vertices() {
    std::map<VertexId, std::pair<VertexId, bool>> origin;
    const auto name = [&](VertexId v, VertexId own, VertexId other) {
      origin.try_emplace(other, v, true);
      origin[own] = {v, false};
    };
    for (int n = 0; n < half_.node_count(); ++n) {
      name({VertexId::Kind::Node, n}, {VertexId::Kind::Node, out_.node[n]}, {VertexId::Kind::Node, out_.image[n]});
      for (int s = 0; s < 4; ++s) {
        const VertexId corner = half_.corner(n, s);
        name(corner, out_.mesh.corner(out_.node[n], s), out_.mesh.corner(out_.image[n], kExchanged[s]));
        const auto middle = [](const HybridMesh& mesh, int node, int side) {
          return VertexId(VertexId::Kind::Edge, mesh.half_edge(node, side) >> 1);
        };
        name(middle(half_, n, s), middle(out_.mesh, out_.node[n], s), middle(out_.mesh, out_.image[n], 3 - s));
      }
    }
    for (const auto& [vertex, of] : origin) out_.origins.push_back({vertex, of.first, of.second});
  }

  const HybridMesh& half_;
  Mirrored out_;
  std::map<HalfEdge, HalfEdge> half_edge_, image_edge_;     // of the half's
  std::map<VertexId, std::pair<VertexId, VertexId>> free_;  // corners of roots
};

}  // namespace

const Mirrored::Origin& Mirrored::origin(VertexId vertex) const {
  const auto at = std::lower_bound(origins.begin(), origins.end(), vertex, [](const Origin& o, VertexId v) { return o.vertex < v; });
  if (at == origins.end() || at->vertex != vertex) throw Error(ErrorCode::Internal, "a vertex is no mirror image");
  return *at;
}

Mirrored mirrored(const HybridMesh& half) { return Mirroring(half).run(); }

std::int64_t count_mirror_sides(const HybridMesh& mesh) {
  std::int64_t sides = 0;
  for (const int leaf : mesh.leaves())
    for (int s = 0; s < 4; ++s) sides += mesh.is_on_mirror(leaf, s);
  return sides;
}

}  // namespace hybrid_mesh
